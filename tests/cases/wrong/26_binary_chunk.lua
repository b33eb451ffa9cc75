LuaS
-- expect: 26_binary_chunk.lua:1 found=a_compiled_chunk

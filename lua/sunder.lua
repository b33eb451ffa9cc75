--- The scene language of sunder.
---
---     local s = require "sunder"
---     return s.scene { solids = { { shape = s.sphere { radius = 1 }, material = s.recipe "tube" } } }
---
--- This file is the module itself (it is compiled into the program) and, through its annotations, what an editor with
--- the Lua language server shows while a scene is being written. `core` is the C side: it checks every value, names
--- the line of what is wrong, and knows all effects from their tables (`sunder explain SCENE` lists them).

local core = ...
local pairs, type = pairs, type

local s = {}

---@alias Vector number[]  three numbers { x, y, z }
---@alias Axis "x"|"y"|"z"|"-x"|"-y"|"-z"|Vector  a direction; a vector need not have length 1
---@alias OfTime Vector|fun(t: number): number, number, number  a constant, or a function of time
---@alias OfPlace Vector|fun(x: number, y: number, z: number): number, number, number  a constant, or a function of place

-- Parameters ----------------------------------------------------------------------------------------------------------

---@class Parameter
---@field [1] number|string|boolean  the value when nobody says otherwise
---@field unit? string
---@field doc? string
---@field min? number
---@field max? number

--- Declares the knobs of a scene and gives their values: the defaults, or what `--set NAME=VALUE` says. The names
--- particles, duration, fps, dx, dt, seed and cfl act on the scene without being said again.
---@param declared table<string, number|string|boolean|Parameter|Choice>
---@return table<string, any>  read-only; a name that was not declared is an error
function s.params(declared)
  return core.params(declared)
end

---@class Choice

--- One of several names; the first is the default.
---@param names string[]
---@return Choice
function s.choice(names)
  return core.choice(names)
end

-- The scene -----------------------------------------------------------------------------------------------------------

--- A material says its density and names the effects that it has. `false` leaves an effect out, `true` takes its
--- defaults.
--- A number, or a function of place that is asked once for each particle, at the start. Density, E, sigma_c, break_stretch, eta
--- and gamma may be one.
---@alias OfParticle number|fun(x: number, y: number, z: number): number

---@class Material
---@field density OfParticle
---@field name? string
---@field [string] table|boolean|number  effect = { key = value, … }

---@class Solid
---@field name? string
---@field shape Shape
---@field material Material|string  a table, or the name of a recipe
---@field fibres? Fibres
---@field velocity? OfPlace  at the start; at rest if absent
---@field sampling? "lattice"|"jittered"|"poisson"  "jittered" if absent
---@field discretisation? "particles"|"tetrahedra"  "particles" if absent
---@field mesher? "lattice"|"gmsh"  of tetrahedra: a lattice in any shape ("lattice" if absent), or Gmsh within a mesh of triangles
---@field start? Vector|fun(x: number, y: number, z: number): number, number, number  where a vertex is at time 0; tetrahedra only
---@field notches? Shape[]  what lies inside starts broken; for a gap without material subtract a shape: `shape - cut`

--- A cut that a sheet has from the start: the straight line from … to, or a thin shape.
---@class Notch
---@field from? Vector
---@field to? Vector
---@field shape? Shape

--- Feeds what diffuses in a sheet: everywhere, inside a shape, or in round spots at random places.
---@class Source
---@field shape? Shape
---@field spots? integer  with radius
---@field radius? number
---@field rate? number|fun(x: number, y: number, z: number): number  added a unit of time
---@field value? number|fun(x: number, y: number, z: number): number  held
---@field start? number  0 if absent
---@field stop? number  never if absent

--- A sheet: one layer of particles where a plane cuts a shape, or on a shape's surface.
---@class Sheet
---@field name? string
---@field shape Shape
---@field material Material|string
---@field thickness number
---@field spacing? number  of particles; from dx or particles if absent
---@field lattice? "square"|"hexagonal"|"scattered"  "square" if absent
---@field radius? number  bonds reach this many spacings, 1.2 to 6; 1.5 if absent
---@field surface? boolean  the shape's own surface instead of a plane's cut
---@field point? Vector  of the plane; the origin if absent
---@field normal? Axis  of the plane; z if absent
---@field ripple? number  random places out of the plane at the start, in spacings
---@field notches? Notch[]
---@field sources? Source[]
---@field grain? Fibres  direction in which the material's grain runs
---@field velocity? OfPlace

--- A grip takes hold of whatever is inside a moving region.
---@class Grip
---@field name? string
---@field shape Shape  at time 0
---@field velocity? OfTime  holds still if absent
---@field spin? OfTime  angular velocity about the pivot
---@field pivot? Vector  the middle of the shape if absent
---@field start? number  0 if absent
---@field stop? number  never if absent
---@field protects? boolean  what starts inside is never damaged; true if absent

--- A collider is a rigid shape that material cannot enter.
---@class Collider
---@field name? string
---@field shape Shape  at time 0
---@field velocity? OfTime
---@field spin? OfTime
---@field pivot? Vector
---@field start? number
---@field stop? number
---@field contact? "sticky"|"slip"|"separate"  "sticky" if absent
---@field friction? number  Coulomb's coefficient, for slip and separate; 0 if absent

--- A wall keeps material on the side that its normal points to.
---@class Wall
---@field point Vector
---@field normal Axis
---@field contact? "sticky"|"slip"|"separate"
---@field friction? number

--- What a hard case expects of its run. A measure's bare number is the bound of its sense (`sunder stress --measures`); { low, high } is a range.
---@class Expect
---@field stop? string  it must end with a message that has these words, instead of running to its end
---@field known_limit? string  it does not hold, and this says why and where that is written
---@field turns? { frame: integer, knob: string, value: any }[]  knobs that are turned while it runs
---@field same_as? { variant: string, tolerance: number, length: number?, shift: Vector? }  its last places are those of another variant
---@field [string] number|number[]

---@class Scene
---@field title? string
---@field units? string  a name for the system of units ("SI", "cgs"); output carries it
---@field duration number
---@field fps? number  24 if absent
---@field particles? integer  about how many, over all solids
---@field dx? number|"auto"  grid spacing; "auto": from particles and particles_per_cell
---@field dt? number|"auto"  time step; "auto": the largest that is safe
---@field cfl? number  fraction of the step limit
---@field seed? integer
---@field particles_per_cell? number
---@field transfer? "apic"|"rpic"|"pic"|"flip"
---@field transfer_ratio? number
---@field kernel? "quadratic"|"cubic"
---@field laplacian? "quadratic"|"cubic"
---@field domain? { min: Vector, max: Vector }
---@field expect? Expect  of a hard case: what `sunder stress` holds its run against (docs/stress.md)
---@field gravity? Vector
---@field mass_damping? number
---@field solids? Solid[]
---@field sheets? Sheet[]  instead of solids
---@field grips? Grip[]
---@field colliders? Collider[]
---@field walls? Wall[]

--- The scene: what a scene file returns.
---@param scene Scene
---@return Scene
function s.scene(scene)
  return core.scene(scene)
end

---@class Sweep
---@field scene string  a path from the sweep's folder
---@field over table<string, (number|string|boolean)[]>  names as --set takes them, each with its values; all combinations are run
---@field set? table<string, number|string|boolean>  the same in every run
---@field title? string
---@field recipe? string
---@field frames? integer  all of the scene's if absent

--- Runs of one scene over lists of values: what a file for `sunder sweep` returns.
---
---     return s.sweep { scene = "scenes/solid/sigma_eta.lua", over = { break_stretch = { 0.1, 0.2 }, eta = { 0.02, 0.1 } } }
---@param sweep Sweep
---@return Sweep
function s.sweep(sweep)
  return core.sweep(sweep)
end

--- A material from recipes/NAME.lua (beside the scene, in a folder above it, or in $SUNDER_RECIPES; a name that ends
--- in .lua is a path from the scene). Overrides replace single keys; `effect = false` turns an effect off.
---
---     s.recipe("tube", { damage = { eta = 0.1 }, fibres = false })
---@param name string
---@param overrides? table
---@return Material
function s.recipe(name, overrides)
  local material = core.recipe(name, overrides)
  for effect, given in pairs(overrides or {}) do
    local own = material[effect]
    if type(own) == "table" and type(given) == "table" then
      for key, value in pairs(given) do
        -- Two keys of an effect may say the same thing (break_stretch, sigma_c): the one that is said last holds.
        local twin = core.twin(effect, key)
        if twin and given[twin] == nil then own[twin] = nil end
        own[key] = value
      end
    elseif not (own and given == true) then
      material[effect] = given
    end
  end
  return material
end

-- Shapes --------------------------------------------------------------------------------------------------------------

---@class Shape
---@operator add(Shape): Shape  union
---@operator mul(Shape): Shape  intersection
---@operator sub(Shape): Shape  difference
---@field union fun(self: Shape, ...: Shape): Shape
---@field intersection fun(self: Shape, ...: Shape): Shape
---@field difference fun(self: Shape, ...: Shape): Shape
---@field translate fun(self: Shape, vector: Vector): Shape
---@field rotate fun(self: Shape, turn: { axis: Axis, angle: number, center?: Vector }): Shape
---@field scale fun(self: Shape, factor: number): Shape

---@param t { radius: number, center?: Vector }
---@return Shape
function s.sphere(t)
  return core.shape("sphere", t)
end

---@param t { min: Vector, max: Vector } | { center?: Vector, size: Vector }
---@return Shape
function s.box(t)
  return core.shape("box", t)
end

--- A flat box around the plane z = center.z, for sheets.
---@param t { size: number[], center?: Vector }
---@return Shape
function s.rectangle(t)
  return core.shape("box", { center = t.center or { 0, 0, 0 }, size = { t.size[1], t.size[2], t.size[1] + t.size[2] } })
end

--- A cylinder along z, for sheets.
---@param t { radius: number, center?: Vector }
---@return Shape
function s.disk(t)
  return core.shape("cylinder", { axis = "z", radius = t.radius, length = t.radius, center = t.center or { 0, 0, 0 } })
end

-- Whether q lies in the triangle a b c, borders included; all run counter-clockwise.
local function holds(a, b, c, q)
  local function side(u, v)
    return (v[1] - u[1]) * (q[2] - u[2]) - (v[2] - u[2]) * (q[1] - u[1])
  end
  return side(a, b) >= 0 and side(b, c) >= 0 and side(c, a) >= 0
end

-- A triangle as three half-spaces, a hair larger than it is: neighbours must not leave a seam.
local function triangle(a, b, c, slab, hair)
  local shape = slab
  for _, edge in ipairs { { a, b }, { b, c }, { c, a } } do
    local u, v = edge[1], edge[2]
    local nx, ny = v[2] - u[2], u[1] - v[1]
    local length = math.sqrt(nx * nx + ny * ny)
    nx, ny = nx / length, ny / length
    shape = shape * core.shape("half_space", { point = { u[1] + hair * nx, u[2] + hair * ny, 0 }, normal = { nx, ny, 0 } })
  end
  return shape
end

--- A prism along z over a polygon without crossings, for sheets: corners { {x, y}, … } in order.
---@param corners number[][]
---@return Shape
function s.polygon(corners)
  local left, area, low, high = {}, 0, { math.huge, math.huge }, { -math.huge, -math.huge }
  for i, corner in ipairs(corners) do
    local after = corners[i % #corners + 1]
    left[i] = corner
    area = area + corner[1] * after[2] - corner[2] * after[1]
    for axis = 1, 2 do
      low[axis], high[axis] = math.min(low[axis], corner[axis]), math.max(high[axis], corner[axis])
    end
  end
  if area < 0 then
    for i = 1, #corners do left[i] = corners[#corners + 1 - i] end
  end
  local size = math.max(high[1] - low[1], high[2] - low[2])
  local slab = core.shape("box", { min = { low[1] - size, low[2] - size, -size }, max = { high[1] + size, high[2] + size, size } })
  local whole
  -- Ears are cut off one by one.
  while #left >= 3 do
    local cut
    for i = 1, #left do
      local a, b, c = left[(i - 2) % #left + 1], left[i], left[i % #left + 1]
      local ear = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1]) > 0
      for j = 1, #left do
        local q = left[j]
        ear = ear and (q == a or q == b or q == c or not holds(a, b, c, q))
      end
      if ear then cut = i break end
    end
    if not cut then error("s.polygon: corners of a polygon that does not cross itself are expected", 2) end
    local piece = triangle(left[(cut - 2) % #left + 1], left[cut], left[cut % #left + 1], slab, 1e-9 * size)
    whole = whole and whole + piece or piece
    table.remove(left, cut)
  end
  if not whole then error("s.polygon: at least three corners are expected", 2) end
  return whole
end

---@param t { axis: Axis, radius: number, length: number, center?: Vector }
---@return Shape
function s.cylinder(t)
  return core.shape("cylinder", t)
end

--- A cylinder with a hole along its axis. `taper` scales both radii, linearly, to that factor at the far end.
---@param t { axis: Axis, outer: number, inner: number, length: number, center?: Vector, taper?: number }
---@return Shape
function s.tube(t)
  return core.shape("tube", t)
end

---@param t { from: Vector, to: Vector, radius: number }
---@return Shape
function s.capsule(t)
  return core.shape("capsule", t)
end

--- A ring of radius `major` around the axis, `minor` thick.
---@param t { axis: Axis, major: number, minor: number, center?: Vector }
---@return Shape
function s.torus(t)
  return core.shape("torus", t)
end

--- Everything behind a plane: the normal points out of it. Without an end, so good for cutting and for colliders.
---@param t { normal: Axis, point?: Vector }
---@return Shape
function s.half_space(t)
  return core.shape("half_space", t)
end

--- The inside of a triangle mesh from an OBJ, PLY or STL file; `file` is a path from the scene's folder. The surface must be
--- closed. The mesh is scaled, turned (`angle` in degrees) about the origin, and then moved so that the middle of its box
--- comes to lie at `center`; without a center it stays where it is.
---@param t { file: string, scale?: number, center?: Vector, rotate?: { axis: Axis, angle: number } }
---@return Shape
function s.mesh(t)
  return core.mesh(t)
end

--- What is in any of the shapes. Also `a + b`.
---@param ... Shape|Shape[]
---@return Shape
function s.union(...)
  return core.combine("union", ...)
end

--- What is in all of the shapes. Also `a * b`.
---@param ... Shape|Shape[]
---@return Shape
function s.intersection(...)
  return core.combine("intersection", ...)
end

--- What is in the first shape and in none of the others. Also `a - b`.
---@param base Shape
---@param ... Shape|Shape[]
---@return Shape
function s.difference(base, ...)
  return core.combine("difference", base, ...)
end

---@param shape Shape
---@param vector Vector
---@return Shape
function s.translate(shape, vector)
  return core.translate(shape, vector)
end

--- Turns a shape by `angle` degrees around an axis through `center` (the origin if absent), counter-clockwise as seen
--- from where the axis points to.
---@param shape Shape
---@param turn { axis: Axis, angle: number, center?: Vector }
---@return Shape
function s.rotate(shape, turn)
  return core.rotate(shape, turn)
end

--- Scales a shape about the origin.
---@param shape Shape
---@param factor number
---@return Shape
function s.scale(shape, factor)
  return core.scale(shape, factor)
end

-- Fibres --------------------------------------------------------------------------------------------------------------

---@class Fibres

s.fibres = {}

--- The same direction everywhere; a second vector lays a second family.
---@param first Vector
---@param second? Vector
---@return Fibres
function s.fibres.direction(first, second)
  return core.fibres("direction", first, second)
end

--- A direction for each place: three numbers, or six for two families. Called once for each particle, at the start.
---@param direction fun(x: number, y: number, z: number): number, number, number, number?, number?, number?
---@return Fibres
function s.fibres.field(direction)
  return core.fibres("field", direction)
end

--- Away from an axis.
---@param t { axis: Axis, center?: Vector }
---@return Fibres
function s.fibres.radial(t)
  return core.fibres("radial", t)
end

--- Around an axis, like hoops.
---@param t { axis: Axis, center?: Vector }
---@return Fibres
function s.fibres.circumferential(t)
  return core.fibres("circumferential", t)
end

--- Around an axis and climbing along it: `angle` degrees from the hoop (0) towards the axis (90).
---@param t { axis: Axis, angle: number, center?: Vector }
---@return Fibres
function s.fibres.helical(t)
  return core.fibres("helical", t)
end

--- Along a curve through points (closed when the last is the first): everywhere the direction that the curve has where it
--- is nearest. `second` lays a second family, the part of that direction which is orthogonal to the first.
---@param t { points: Vector[], second?: Axis }
---@return Fibres
function s.fibres.curve(t)
  return core.fibres("curve", t)
end

--- At random within `spread` degrees of a direction (90: any), each particle for itself. The scene's seed counts if absent.
---@param t { direction: Axis, spread: number, seed?: integer }
---@return Fibres
function s.fibres.random(t)
  return core.fibres("random", t)
end

--- From rows x, y, z, dx, dy, dz of a CSV file (nine numbers: two families); `path` starts in the scene's folder.
---@param t { path: string, method?: "nearest"|"inverse_distance" }  "nearest" if absent
---@return Fibres
function s.fibres.file(t)
  return core.fibres("file", t)
end

--- Along a flow through the body, from where it overlaps `inflow` to where it overlaps `outflow`; no other surface lets it
--- pass. `shape` is where the flow runs (the body's own if absent), `resolution` the number of cubes along its longest
--- side (as many as make 30000 if absent). `second` as for curves.
---@param t { inflow: Shape, outflow: Shape, shape?: Shape, resolution?: integer, second?: Axis }
---@return Fibres
function s.fibres.flow(t)
  return core.fibres("flow", t)
end

return s

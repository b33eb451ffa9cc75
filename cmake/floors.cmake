# The floors, from the ground up. A floor links only those below it.
file(GLOB BASE_SOURCES CONFIGURE_DEPENDS src/base/*.c)
sunder_floor(base SOURCES ${BASE_SOURCES} USES PkgConfig::XXHASH OpenMP::OpenMP_C Threads::Threads m)
file(GLOB GEOM_SOURCES CONFIGURE_DEPENDS src/geom/*.c)
sunder_floor(geom SOURCES ${GEOM_SOURCES} USES sunder_base)
sunder_floor(effect SOURCES src/effect/effect.c USES sunder_base)

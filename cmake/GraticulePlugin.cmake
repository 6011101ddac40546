# graticule_add_plugin(NAME SOURCES...): a plug-in, lib<NAME>.so, which `graticule --plugin` loads.
#
# Works alike in Graticule's own tree and after find_package(graticule).  A plug-in links nothing of
# Graticule or Ceres: it meets its host only through the C table that factors/sdk.hpp writes, so compiler,
# flags and the version of Eigen may differ on the two sides.
include_guard(GLOBAL)
include(CheckCXXCompilerFlag)

function(graticule_add_plugin name)
  if(NOT ARGN)
    message(FATAL_ERROR "graticule_add_plugin(${name} ...): expected source files after the name")
  endif()
  add_library(${name} MODULE ${ARGN})
  target_link_libraries(${name} PRIVATE graticule::sdk)
  target_compile_features(${name} PRIVATE cxx_std_17)
  # Two plug-ins may have structs of the same name: nothing but the entry is visible, and nothing is bound
  # across libraries that were loaded apart (GNU's unique symbols are, RTLD_LOCAL or not).
  set_target_properties(${name} PROPERTIES
    PREFIX lib
    SUFFIX .so
    CXX_VISIBILITY_PRESET hidden
    VISIBILITY_INLINES_HIDDEN ON)
  check_cxx_compiler_flag(-fno-gnu-unique GRATICULE_HAS_NO_GNU_UNIQUE)
  if(GRATICULE_HAS_NO_GNU_UNIQUE)
    target_compile_options(${name} PRIVATE -fno-gnu-unique)
  endif()
endfunction()

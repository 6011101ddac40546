# One library a room.  `#include "graticule/solver/graph.hpp"` is spelled alike in the tree and installed: in the
# build tree a link leads to the source folder.  Each room has an include root of its own, so that a room sees
# only the rooms it links.

set(GRATICULE_VERSION_INCLUDE "${PROJECT_BINARY_DIR}/include/version")

# Headers of solver/ that are not installed: they show how it is done, and need CHOLMOD, glog or Ceres.
set(GRATICULE_INTERNAL_HEADERS bayes_tree block_cholesky ceres_bridge direct_minimiser evaluation front gaussian guarded linearise marginalise normal_equations online_machine parallel_evaluation snapshots sparse_inverse)

add_library(graticule_flags INTERFACE)
target_compile_options(graticule_flags INTERFACE
  -Wall -Wextra -Wpedantic -Wconversion -Wno-sign-conversion
  $<$<BOOL:${GRATICULE_WARNINGS_ARE_ERRORS}>:-Werror>)
# The same digits from every build: no contraction into fused multiply-adds behind our back.
target_compile_options(graticule_flags INTERFACE -ffp-contract=off)
# Debian's libceres was built with 16-byte malloc alignment in mind; Eigen must not switch to its own
# allocator where a sanitizer replaces malloc.
target_compile_definitions(graticule_flags INTERFACE EIGEN_MALLOC_ALREADY_ALIGNED=1)
if(GRATICULE_SANITIZE)
  add_compile_options(-fsanitize=${GRATICULE_SANITIZE} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${GRATICULE_SANITIZE})
endif()

# graticule_library(ROOM SOURCES...)
function(graticule_library room)
  set(target graticule_${room})
  add_library(${target} ${ARGN})
  add_library(graticule::${room} ALIAS ${target})
  set(root "${PROJECT_BINARY_DIR}/include/${room}")
  file(MAKE_DIRECTORY "${root}/graticule")
  file(CREATE_LINK "${PROJECT_SOURCE_DIR}/${room}" "${root}/graticule/${room}" SYMBOLIC)
  target_include_directories(${target} PUBLIC "$<BUILD_INTERFACE:${root}>" "$<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>")
  target_compile_features(${target} PUBLIC cxx_std_17)
  target_link_libraries(${target} PRIVATE $<BUILD_INTERFACE:graticule_flags>)
  # Every symbol of a room is for others: nothing is marked for export, so shared and static objects are the same.
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${room} OUTPUT_NAME graticule_${room} DEFINE_SYMBOL "")
endfunction()

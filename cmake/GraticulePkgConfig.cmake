# graticule.pc (solver and factors) and one a component, for those who build without CMake.
#
# A static library names what it was linked with, and there is no shared one beside it: so all of that is in
# `Requires` and `Libs`, and `pkg-config --libs graticule` is enough.  Shared libraries bring their own.  They have no
# private lists: there is no archive beside them that `--static` could link, and pkg-config wants what
# `Requires.private` names to be installed even for `--cflags`.
# Ceres, SuiteSparse, bzip2 and OpenCV's small packages have no .pc file on Debian 12: they are named as libraries.
file(RELATIVE_PATH graticule_prefix_from_pc "${CMAKE_INSTALL_FULL_LIBDIR}/pkgconfig" "${CMAKE_INSTALL_PREFIX}")

# graticule_pkg_config(NAME DESCRIPTION [LIBRARY lib] [REQUIRES ...] [DEBIAN ...] [LINK ...])
# REQUIRES: .pc files whose headers a consumer sees.  DEBIAN, LINK: what a static library was linked with.
function(graticule_pkg_config name description)
  cmake_parse_arguments(arg "" "LIBRARY" "REQUIRES;DEBIAN;LINK" ${ARGN})
  set(text "prefix=\${pcfiledir}/${graticule_prefix_from_pc}
includedir=\${prefix}/${CMAKE_INSTALL_INCLUDEDIR}
libdir=\${prefix}/${CMAKE_INSTALL_LIBDIR}
plugindir=\${prefix}/${GRATICULE_PLUGIN_INSTALL_DIR}

Name: ${name}
Description: ${description}
Version: ${PROJECT_VERSION}
")
  if(BUILD_SHARED_LIBS)
    set(arg_DEBIAN)
    set(arg_LINK)
  endif()
  list(JOIN arg_LINK " " link)
  list(APPEND arg_REQUIRES ${arg_DEBIAN})
  list(JOIN arg_REQUIRES ", " requires)
  string(APPEND text "Requires: ${requires}\n")
  if(arg_LIBRARY)
    string(APPEND text "Libs: -L\${libdir} -l${arg_LIBRARY} ${link}\n")
  endif()
  string(APPEND text "Cflags: -I\${includedir}\n")
  file(GENERATE OUTPUT "${PROJECT_BINARY_DIR}/pkgconfig/${name}.pc" CONTENT "${text}")
  install(FILES "${PROJECT_BINARY_DIR}/pkgconfig/${name}.pc"
    DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig" COMPONENT dev)
endfunction()

graticule_pkg_config(graticule-sdk "What a plug-in of Graticule needs: headers" REQUIRES eigen3)
# OpenBLAS before all others, and whether or not it is called by name: see solver/CMakeLists.txt.
graticule_pkg_config(graticule-solver "Factor graphs as data, solved by Ceres" LIBRARY graticule_solver
  REQUIRES eigen3
  DEBIAN libglog
  LINK -Wl,--push-state -Wl,--no-as-needed -lopenblas -Wl,--pop-state -lceres -lcholmod -ldl)
graticule_pkg_config(graticule-factors "Graticule's built-in factors" LIBRARY graticule_factors
  REQUIRES graticule-solver graticule-sdk LINK -ldl)
graticule_pkg_config(graticule-io "Graticule's formats, reports and pictures" LIBRARY graticule_io
  REQUIRES graticule-solver
  DEBIAN libpng zlib fmt yaml-cpp libxxhash liblzf liblz4
  LINK -lbz2 -lopencv_videoio -lopencv_imgcodecs -lopencv_imgproc -lopencv_core -ldl)
graticule_pkg_config(graticule-problems "Graticule's problems: maps, cameras, signals, scans"
  LIBRARY graticule_problems
  REQUIRES graticule-factors graticule-io
  DEBIAN geographiclib apriltag
  LINK -lopencv_calib3d -lopencv_imgproc -lopencv_videoio -lopencv_core -lcholmod)
graticule_pkg_config(graticule "Factor graphs as data, solved by Ceres: solver and factors"
  REQUIRES graticule-factors graticule-solver)

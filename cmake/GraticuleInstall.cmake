# What `cmake --install` lays down: a library and the headers of each room, what find_package(graticule) and
# pkg-config read (component dev); the programs, their manual, their configurations and the folder where plug-ins are
# found (component runtime).
include(CMakePackageConfigHelpers)

set(GRATICULE_PACKAGE_DIR "${CMAKE_INSTALL_LIBDIR}/cmake/graticule")

list(JOIN GRATICULE_INTERNAL_HEADERS "|" internal)

set(GRATICULE_INSTALLED_COMPONENTS sdk)
foreach(room IN ITEMS solver factors io problems)
  if(NOT TARGET graticule_${room})
    continue()
  endif()
  list(APPEND GRATICULE_INSTALLED_COMPONENTS ${room})
  install(TARGETS graticule_${room} EXPORT graticule_${room}
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT dev
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT runtime NAMELINK_COMPONENT dev
    RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
  install(EXPORT graticule_${room} NAMESPACE graticule:: FILE graticule-${room}.cmake
    DESTINATION "${GRATICULE_PACKAGE_DIR}" COMPONENT dev)
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/${room}/" DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/graticule/${room}"
    COMPONENT dev
    FILES_MATCHING
    PATTERN "*.hpp"
    PATTERN "*.h"
    REGEX "/solver/(${internal})\\.hpp$" EXCLUDE)
endforeach()
install(FILES "${GRATICULE_VERSION_INCLUDE}/graticule/version.hpp"
  DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}/graticule" COMPONENT dev)

# Shared libraries find each other, and the program finds them, wherever the installation was moved.
if(BUILD_SHARED_LIBS)
  file(RELATIVE_PATH libdir_from_bindir "${CMAKE_INSTALL_FULL_BINDIR}" "${CMAKE_INSTALL_FULL_LIBDIR}")
  foreach(room IN ITEMS solver factors io problems)
    if(TARGET graticule_${room})
      set_target_properties(graticule_${room} PROPERTIES INSTALL_RPATH "$ORIGIN"
        VERSION "${PROJECT_VERSION}" SOVERSION "${PROJECT_VERSION_MAJOR}.${PROJECT_VERSION_MINOR}")
    endif()
  endforeach()
  if(TARGET graticule_cli)
    set_target_properties(graticule_cli graticule_vision PROPERTIES INSTALL_RPATH "$ORIGIN/${libdir_from_bindir}")
  endif()
endif()
if(TARGET graticule_cli)
  install(TARGETS graticule_cli graticule_vision RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}"
    COMPONENT runtime)
  include(GraticuleManual)
endif()
if(TARGET graticule_mpi)
  if(BUILD_SHARED_LIBS)
    set_target_properties(graticule_mpi PROPERTIES INSTALL_RPATH "$ORIGIN/${libdir_from_bindir}")
  endif()
  install(TARGETS graticule_mpi RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT mpi)
endif()
if(EXISTS "${PROJECT_SOURCE_DIR}/apps/configs")
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/apps/configs/"
    DESTINATION "${CMAKE_INSTALL_DATADIR}/graticule/configs" COMPONENT runtime FILES_MATCHING PATTERN "*.yaml")
endif()
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT outside_packages)
# Debian's packages have them where they look for them: GraticulePackages.cmake.
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/examples" DESTINATION "${CMAKE_INSTALL_DOCDIR}"
  COMPONENT outside_packages PATTERN build EXCLUDE)
install(DIRECTORY DESTINATION "${GRATICULE_PLUGIN_INSTALL_DIR}" COMPONENT runtime)

if(BUILD_SHARED_LIBS)
  set(BUILD_SHARED_LIBS_TEXT TRUE)
else()
  set(BUILD_SHARED_LIBS_TEXT FALSE)
endif()
configure_package_config_file(
  "${PROJECT_SOURCE_DIR}/cmake/graticuleConfig.cmake.in" "${PROJECT_BINARY_DIR}/graticuleConfig.cmake"
  INSTALL_DESTINATION "${GRATICULE_PACKAGE_DIR}"
  PATH_VARS CMAKE_INSTALL_INCLUDEDIR GRATICULE_PLUGIN_INSTALL_DIR)
# Before 1.0 a minor version may break a program that embeds Graticule; plug-ins have a version of their own.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/graticuleConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES
  "${PROJECT_BINARY_DIR}/graticuleConfig.cmake"
  "${PROJECT_BINARY_DIR}/graticuleConfigVersion.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/GraticulePlugin.cmake"
  "${PROJECT_SOURCE_DIR}/cmake/GraticuleOpenCv.cmake"
  DESTINATION "${GRATICULE_PACKAGE_DIR}" COMPONENT dev)
include(GraticulePkgConfig)
include(GraticulePackages)

# Debian packages: `cpack` in the build tree writes graticule (the programs), libgraticule-dev (libraries,
# headers, what finds them) and, where there is something to put into them, python3-graticule and graticule-mpi.
# tests/install/packages_test.py holds what is said here against what the packages need.
set(GRATICULE_MAINTAINER "The Graticule authors <maintainers@graticule.example>" CACHE STRING
    "Maintainer of the Debian packages: Name <address>")
mark_as_advanced(GRATICULE_MAINTAINER)

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME graticule)
set(CPACK_PACKAGE_VERSION "${PROJECT_VERSION}")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "factor graphs as data, solved by Ceres")
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_PACKAGING_INSTALL_PREFIX "${GRATICULE_PACKAGE_PREFIX}")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_MAINTAINER "${GRATICULE_MAINTAINER}")
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)
string(CONCAT about
  "Graticule solves recorded factor graphs (pose graphs, bundle adjustment and\n"
  "its own format), compares solver configurations on them, makes occupancy maps\n"
  "of laser logs, calibrates cameras, finds where a camera is on its LIDAR, parts\n"
  "scans into objects, and predicts signal strength between moving robots.")

set(CPACK_COMPONENTS_ALL runtime dev)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME graticule)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION science)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SHLIBDEPS ON)
# Opened by its name when the first picture is drawn: no tool sees it.
set(CPACK_DEBIAN_RUNTIME_PACKAGE_DEPENDS "librsvg2-2")
set(CPACK_DEBIAN_RUNTIME_PACKAGE_RECOMMENDS "fonts-dejavu-core")
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION "${about}")

# What the targets of graticuleConfig.cmake and the .pc files lead to.
set(GRATICULE_DEV_PACKAGES libeigen3-dev libceres-dev libsuitesparse-dev libopenblas-dev)
if(NOT BUILD_SHARED_LIBS)  # io's and problems' archives name what they were linked with
  list(APPEND GRATICULE_DEV_PACKAGES
    libpng-dev zlib1g-dev libfmt-dev libyaml-cpp-dev nlohmann-json3-dev libxxhash-dev liblzf-dev
    libbz2-dev liblz4-dev pkg-config
    libopencv-calib3d-dev libopencv-imgcodecs-dev libopencv-videoio-dev libgeographiclib-dev libapriltag-dev)
endif()
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libgraticule-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
list(JOIN GRATICULE_DEV_PACKAGES ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_DEV_PACKAGE_RECOMMENDS "graticule (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE})")
set(CPACK_DEBIAN_DEV_DESCRIPTION "${about}\n.\n\
This package has the libraries and headers, to embed it and to write\nplug-ins.")
if(BUILD_SHARED_LIBS)
  set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
  # Where packages beside it find its libraries while they are made.
  foreach(room IN ITEMS solver factors io problems)
    list(APPEND CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}/${room}")
  endforeach()
  set(CPACK_DEBIAN_RUNTIME_PACKAGE_CONTROL_EXTRA "${PROJECT_SOURCE_DIR}/packaging/triggers")
  string(PREPEND CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
    "graticule (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}), ")
endif()

get_cmake_property(components COMPONENTS)
foreach(component IN ITEMS python mpi)
  if(component IN_LIST components)
    list(APPEND CPACK_COMPONENTS_ALL ${component})
  endif()
endforeach()
set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-graticule)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3, python3-numpy")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "${about}\n.\n\
This package has the Python module.")

# Of its own: who has one machine needs no MPI.
set(CPACK_DEBIAN_MPI_PACKAGE_NAME graticule-mpi)
set(CPACK_DEBIAN_MPI_PACKAGE_SECTION science)
set(CPACK_DEBIAN_MPI_PACKAGE_SHLIBDEPS ON)
# The same version: it is a part of the program that it lies beside.
set(CPACK_DEBIAN_MPI_PACKAGE_DEPENDS
    "graticule (= ${PROJECT_VERSION}-${CPACK_DEBIAN_PACKAGE_RELEASE}), librsvg2-2")
set(CPACK_DEBIAN_MPI_PACKAGE_RECOMMENDS "openmpi-bin")
set(CPACK_DEBIAN_MPI_DESCRIPTION "${about}\n.\n\
This package spreads comparisons and searches for parameters over the processes\nof mpirun or srun.")

# Each package says its licence and its changes; with `cmake --install` these stay out.
set(changelog "${PROJECT_BINARY_DIR}/packaging/changelog.Debian")
configure_file("${PROJECT_SOURCE_DIR}/packaging/changelog.in" "${changelog}" @ONLY)
execute_process(COMMAND "${GRATICULE_GZIP}" -9nf "${changelog}" COMMAND_ERROR_IS_FATAL ANY)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} COMPONENT)
  set(doc "${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${COMPONENT}_PACKAGE_NAME}")
  install(FILES "${PROJECT_SOURCE_DIR}/packaging/copyright" "${changelog}.gz" DESTINATION "${doc}"
    COMPONENT ${component} EXCLUDE_FROM_ALL)
endforeach()
install(DIRECTORY "${PROJECT_SOURCE_DIR}/docs/examples"
  DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_DEV_PACKAGE_NAME}"
  COMPONENT dev EXCLUDE_FROM_ALL PATTERN build EXCLUDE)

include(CPack)

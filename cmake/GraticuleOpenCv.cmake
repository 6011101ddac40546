# Targets graticule_opencv::<module> of OpenCV 4.  Debian keeps OpenCVConfig.cmake in a package that brings every
# module, with Qt and VTK; those that are used have libraries and headers in small packages of their own.
find_path(GRATICULE_OPENCV_INCLUDE_DIR opencv2/core.hpp PATH_SUFFIXES opencv4)
mark_as_advanced(GRATICULE_OPENCV_INCLUDE_DIR)
foreach(module IN ITEMS core imgproc imgcodecs calib3d videoio)
  find_library(GRATICULE_OPENCV_${module} opencv_${module})
  mark_as_advanced(GRATICULE_OPENCV_${module})
  if(NOT GRATICULE_OPENCV_${module} OR NOT GRATICULE_OPENCV_INCLUDE_DIR)
    message(FATAL_ERROR "OpenCV's ${module} was not found: install libopencv-${module}-dev")
  endif()
  if(NOT TARGET graticule_opencv::${module})
    add_library(graticule_opencv::${module} UNKNOWN IMPORTED)
    set_target_properties(graticule_opencv::${module} PROPERTIES
      IMPORTED_LOCATION "${GRATICULE_OPENCV_${module}}"
      INTERFACE_SYSTEM_INCLUDE_DIRECTORIES "${GRATICULE_OPENCV_INCLUDE_DIR}"
      INTERFACE_INCLUDE_DIRECTORIES "${GRATICULE_OPENCV_INCLUDE_DIR}")
  endif()
endforeach()

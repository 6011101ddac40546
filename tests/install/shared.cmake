# cmake -D SOURCE=... -D BUILD=... -P shared.cmake: builds Graticule with shared libraries, and examples against them
# (examples.cmake).  Objects are those of the static build: by ccache it is a matter of linking, where BUILD is as deep
# in the source as the static build is.  Prints "skipped: " without ccache, which ctest takes for a skipped test.
if(NOT LAUNCHER MATCHES "ccache")
  message("skipped: without ccache as CMAKE_CXX_COMPILER_LAUNCHER everything would be compiled again")
  return()
endif()
set(ENV{CCACHE_BASEDIR} "${SOURCE}")
set(ENV{CCACHE_NOHASHDIR} 1)
foreach(arguments IN ITEMS
    "-S;${SOURCE};-B;${BUILD};-G;${GENERATOR};-DBUILD_SHARED_LIBS=ON;-DCMAKE_BUILD_TYPE=${CONFIG};-DCMAKE_CXX_COMPILER=${CXX};-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER};-DGRATICULE_BUILD_TESTS=OFF;-DGRATICULE_BUILD_PYTHON=OFF;-DGRATICULE_BUILD_BENCH=OFF"
    "--build;${BUILD}")
  execute_process(COMMAND "${CMAKE_COMMAND}" ${arguments} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE out)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${arguments}: exit ${code}\n${out}")
  endif()
endforeach()
include("${CMAKE_CURRENT_LIST_DIR}/examples.cmake")
foreach(room IN ITEMS solver factors io problems)
  if(NOT EXISTS "${moved}/${LIBDIR}/libgraticule_${room}.so")
    message(FATAL_ERROR "libgraticule_${room}.so is not installed")
  endif()
endforeach()

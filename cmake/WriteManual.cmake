# cmake -D PROGRAM=... -D TO=... -D GZIP=... -P WriteManual.cmake: see GraticuleManual.cmake.
# (A sanitizer's word about leaks at exit is for the tests.)
set(ENV{ASAN_OPTIONS} "detect_leaks=0:$ENV{ASAN_OPTIONS}")

function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code ERROR_VARIABLE errors)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "${ARGN}: exit ${code}\n${errors}")
  endif()
endfunction()

file(REMOVE_RECURSE "${TO}")
run("${PROGRAM}" manual man --output "${TO}/man1")
foreach(shell IN ITEMS bash zsh fish)
  run("${PROGRAM}" manual ${shell} --output "${TO}/${shell}")
endforeach()
file(GLOB pages "${TO}/man1/*.1")
run("${GZIP}" -9n ${pages})  # without a time: the same program, the same bytes
file(TOUCH "${TO}/written")

# cmake -D PROGRAM=... -D PAGE=docs/reference.md -P reference.cmake
execute_process(COMMAND "${PROGRAM}" manual markdown OUTPUT_VARIABLE said COMMAND_ERROR_IS_FATAL ANY)
file(READ "${PAGE}" page)
if(NOT said STREQUAL page)
  message(FATAL_ERROR "${PAGE} is old: write it anew by `graticule manual markdown > docs/reference.md`")
endif()

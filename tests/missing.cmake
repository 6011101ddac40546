# cmake -D PACKAGE=... -P missing.cmake: in place of tests that need a package which was not there when this tree was
# configured.  They are skipped, and said to be; where CI=true that is a failure.
if("$ENV{CI}" STREQUAL "true")
  message(FATAL_ERROR "${PACKAGE} is missing: .ci/packages.txt has it")
endif()
message("skipped: ${PACKAGE} is missing")

# Manual pages and completion scripts, written by the program itself as it is built, so that they say what it
# takes.  graticule_manual makes build/manual/man1/*.1.gz and build/manual/{bash,zsh,fish}.
set(GRATICULE_MANUAL_DIR "${PROJECT_BINARY_DIR}/manual")
find_program(GRATICULE_GZIP gzip REQUIRED)
mark_as_advanced(GRATICULE_GZIP)
add_custom_command(
  OUTPUT "${GRATICULE_MANUAL_DIR}/written"
  COMMAND "${CMAKE_COMMAND}" -D "PROGRAM=$<TARGET_FILE:graticule_cli>" -D "TO=${GRATICULE_MANUAL_DIR}"
    -D "GZIP=${GRATICULE_GZIP}" -P "${PROJECT_SOURCE_DIR}/cmake/WriteManual.cmake"
  DEPENDS graticule_cli "${PROJECT_SOURCE_DIR}/cmake/WriteManual.cmake"
  COMMENT "Writing manual pages and completions"
  VERBATIM)
add_custom_target(graticule_manual ALL DEPENDS "${GRATICULE_MANUAL_DIR}/written")

install(DIRECTORY "${GRATICULE_MANUAL_DIR}/man1" DESTINATION "${CMAKE_INSTALL_MANDIR}" COMPONENT runtime
  PATTERN graticule-mpi.1.gz EXCLUDE)
if(TARGET graticule_mpi)
  install(FILES "${GRATICULE_MANUAL_DIR}/man1/graticule-mpi.1.gz" DESTINATION "${CMAKE_INSTALL_MANDIR}/man1"
    COMPONENT mpi)
endif()
install(FILES "${GRATICULE_MANUAL_DIR}/bash" RENAME graticule
  DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT runtime)
install(FILES "${GRATICULE_MANUAL_DIR}/fish" RENAME graticule.fish
  DESTINATION "${CMAKE_INSTALL_DATADIR}/fish/vendor_completions.d" COMPONENT runtime)
# zsh looks into one folder for what a distribution brings, into another for what was installed by hand.
install(FILES "${GRATICULE_MANUAL_DIR}/zsh" RENAME _graticule
  DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/site-functions" COMPONENT outside_packages)
install(FILES "${GRATICULE_MANUAL_DIR}/zsh" RENAME _graticule
  DESTINATION "${CMAKE_INSTALL_DATADIR}/zsh/vendor-completions" COMPONENT runtime EXCLUDE_FROM_ALL)

# cmake -D BUILD=... -D WORK=... -P examples.cmake: see CMakeLists.txt beside it.

# run(WHAT COMMAND...): stops the test where the command fails; its output is in `output`.
function(run what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT code EQUAL 0)
    string(JOIN " " command ${ARGN})
    message(FATAL_ERROR "${what}: exit ${code}\n  ${command}\n${out}\n${err}")
  endif()
  message(STATUS "${what}: done")
  set(output "${out}" PARENT_SCOPE)
endfunction()

function(expect what text pattern)
  if(NOT text MATCHES "${pattern}")
    message(FATAL_ERROR "${what}: expected '${pattern}' in\n${text}")
  endif()
endfunction()

file(REMOVE_RECURSE "${WORK}")
set(prefix "${WORK}/prefix with space")
run("install" "${CMAKE_COMMAND}" --install "${BUILD}" --config "${CONFIG}" --prefix "${prefix}")

# Moved after it was installed: nothing may remember where it was.
set(moved "${WORK}/moved")
file(RENAME "${prefix}" "${moved}")
if(NOT IS_DIRECTORY "${moved}/${LIBDIR}/graticule/plugins")
  message(FATAL_ERROR "there is no folder for plug-ins in ${moved}")
endif()
if(NOT EXISTS "${moved}/share/doc/graticule/examples/ros2_node/package.xml")
  message(FATAL_ERROR "there are no examples in ${moved}/share/doc")
endif()

foreach(folder IN ITEMS docs/examples/plugin docs/examples/lens docs/examples/embed tests/install/rooms)
  file(COPY "${SOURCE}/${folder}" DESTINATION "${WORK}")
  get_filename_component(example "${folder}" NAME)
  run("configure ${example}" "${CMAKE_COMMAND}" -S "${WORK}/${example}" -B "${WORK}/${example}/build"
    -G "${GENERATOR}" "-DCMAKE_PREFIX_PATH=${moved}" "-DCMAKE_CXX_COMPILER=${CXX}"
    "-DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}" -DCMAKE_BUILD_TYPE=Release "-DCMAKE_CXX_FLAGS=${FLAGS}")
  run("build ${example}" "${CMAKE_COMMAND}" --build "${WORK}/${example}/build")
endforeach()

run("run embed" "${WORK}/embed/build/embed")
expect("embed" "${output}" "converged, chi2")
expect("embed" "${output}" "sigma of x before the loop: 0\\.[0-9]+ m")
expect("embed" "${output}" "converged after [0-9]+ steps")

run("run rooms" "${WORK}/rooms/build/rooms" "${WORK}/rooms.fg")
expect("rooms" "${output}" "converged after [0-9]+ steps")

# The same by pkg-config.
find_program(pkg_config pkg-config REQUIRED)
set(ENV{PKG_CONFIG_PATH} "${moved}/${LIBDIR}/pkgconfig")
separate_arguments(flags UNIX_COMMAND "${FLAGS}")
foreach(room IN ITEMS embed:graticule rooms:graticule-problems)
  string(REPLACE ":" ";" room "${room}")
  list(POP_FRONT room name)
  run("pkg-config ${room}" "${pkg_config}" --cflags --libs ${room})
  separate_arguments(libs UNIX_COMMAND "${output}")
  run("build ${name} by pkg-config" "${CXX}" -std=c++17 ${flags} "${WORK}/${name}/main.cpp" -o "${WORK}/${name}_by_pc" ${libs}
    "-Wl,-rpath,${moved}/${LIBDIR}")
  run("run ${name} by pkg-config" "${WORK}/${name}_by_pc" "${WORK}/rooms.fg")
  expect("${name} by pkg-config" "${output}" "converged after [0-9]+ steps")
endforeach()

set(plugin "${WORK}/plugin/build/libradar.so")
if(NOT EXISTS "${plugin}")
  message(FATAL_ERROR "the plug-in is not where its README says: ${plugin}")
endif()

if(NOT CLI)
  message(STATUS "there is no graticule program in this build: the plug-in was built, not run by it")
  return()
endif()
set(graticule "${moved}/${CLI}")
set(problem "${WORK}/plugin/problem.fg")
run("graticule --version" "${graticule}" --version)
run("solve" "${graticule}" solve --plugin "${plugin}" "${problem}" --json)
expect("solve" "${output}" "\"termination\": *\"converged\"")
run("marginals" "${graticule}" solve --plugin "${plugin}" "${problem}" --marginals all)
run("check" "${graticule}" check --plugin "${plugin}" "${problem}")
run("compare" "${graticule}" compare --plugin "${plugin}" "${problem}" --configs default gauss-newton)

set(lens "${WORK}/lens/build/libdivision.so")
run("types, with a lens" "${graticule}" types --plugin "${lens}")
expect("types, with a lens" "${output}" "reprojection_division/1")

# Without --plugin the types are missing: exit 6, and the message says which.
execute_process(COMMAND "${graticule}" solve "${problem}" RESULT_VARIABLE code OUTPUT_VARIABLE out
  ERROR_VARIABLE err)
if(NOT code EQUAL 6)
  message(FATAL_ERROR "solve without the plug-in: expected exit 6, found ${code}\n${out}\n${err}")
endif()
expect("solve without the plug-in" "${err}" "radar_(doppler|range)/1")

# In the installation's own folder it is found without a word.
file(COPY "${plugin}" DESTINATION "${moved}/${LIBDIR}/graticule/plugins")
run("solve, plug-in installed" "${graticule}" solve "${problem}")

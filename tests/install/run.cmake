# run.cmake: see CMakeLists.txt. Variables: BUILD, WORK, EXAMPLE, GENERATOR, CXX, FLAGS, LPVD.

function(step what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${result}):\n${output}")
  endif()
  message(STATUS "${what}: ok\n${output}")
endfunction()

file(REMOVE_RECURSE ${WORK})
step("install" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix --component lpv-dev)
step("install lpvctl" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix --component lpvctl)
step("install its module" ${CMAKE_COMMAND} --install ${BUILD} --prefix ${WORK}/prefix --component lpvctl_images)
step("configure" ${CMAKE_COMMAND} -S ${EXAMPLE} -B ${WORK}/build -G ${GENERATOR} -DCMAKE_CXX_COMPILER=${CXX}
     -DCMAKE_PREFIX_PATH=${WORK}/prefix -DCMAKE_CXX_FLAGS=${FLAGS})
step("build" ${CMAKE_COMMAND} --build ${WORK}/build)
step("usage" ${WORK}/build/example)
step("installed lpvctl" ${WORK}/prefix/bin/lpvctl --help)
foreach(page man/man1/lpvctl.1 man/man1/lpvctl-light.1 bash-completion/completions/lpvctl zsh/site-functions/_lpvctl
        fish/vendor_completions.d/lpvctl.fish)
  if(NOT EXISTS ${WORK}/prefix/share/${page})
    message(FATAL_ERROR "share/${page} was not installed")
  endif()
endforeach()

# Nobody listens on port 1: a clean message and exit code 3.
execute_process(COMMAND ${WORK}/build/example 127.0.0.1:1 RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE error)
if(NOT result EQUAL 3 OR NOT error MATCHES "^example: 127.0.0.1:1: ")
  message(FATAL_ERROR "without a server: exit ${result}, ${error}")
endif()

# A real call: against LPV_SERVER, else against a server of its own.
if(DEFINED ENV{LPV_SERVER})
  step("call" ${WORK}/build/example $ENV{LPV_SERVER})
  return()
endif()
find_program(BASH bash)
if(NOT BASH)
  return()
endif()
step("call" ${BASH} ${CMAKE_CURRENT_LIST_DIR}/with_server.sh ${LPVD} ${WORK} ${WORK}/build/example)

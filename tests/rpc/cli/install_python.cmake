# install_python.cmake: FOLDER/venv gets the Python package of the checkout ROOT. Variables: PYTHON, ROOT, FOLDER.
# The package is built from copies, so that nothing is written into the checkout; nothing is fetched: what it needs is that
# of Debian's packages.

function(step what)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${what} failed (${result}):\n${output}")
  endif()
endfunction()

file(REMOVE_RECURSE ${FOLDER})
foreach(name pyproject.toml setup.py src)
  file(COPY ${ROOT}/client/python/${name} DESTINATION ${FOLDER}/checkout/client/python PATTERN __pycache__ EXCLUDE)
endforeach()
file(COPY ${ROOT}/proto/lpv/v1 DESTINATION ${FOLDER}/checkout/proto/lpv)
step("python3 -m venv" ${PYTHON} -m venv --system-site-packages --without-pip ${FOLDER}/venv)
step("pip install client/python" ${FOLDER}/venv/bin/python -m pip --disable-pip-version-check install --no-index
     --no-build-isolation --no-deps --no-cache-dir ${FOLDER}/checkout/client/python)
file(TOUCH ${FOLDER}/installed)

# Tests of lpvctl and of what it is made of. Included by tests/rpc/CMakeLists.txt.

lpv_test(cli_import_test unit SOURCES cli/cli_import_test.cpp LIBRARIES lpv_import)

lpv_test(cli_test rpc SOURCES cli/cli_test.cpp LIBRARIES lpv_rpc_testing)
target_compile_definitions(cli_test PRIVATE LPVCTL_PATH="$<TARGET_FILE:lpvctl>")
add_dependencies(cli_test lpvctl)

lpv_test(cli_library_test rpc SOURCES cli/cli_library_test.cpp LIBRARIES lpv_rpc_testing)

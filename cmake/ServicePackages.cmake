# Libraries of the service, found once, for every folder. What only one folder uses is found there.

find_package(Threads REQUIRED)
find_package(Protobuf REQUIRED)            # messages; module mode: Debian ships no CMake package for it
find_package(gRPC CONFIG REQUIRED)         # the transport of the first door
find_package(spdlog CONFIG REQUIRED)       # leveled logs without ceremony

# Pictures in every format, in memory. Through pkg-config: Debian's CMake package does not load where OpenImageIO's
# command line tools are not installed, which bring Qt and which nothing here needs.
find_package(PkgConfig REQUIRED)
pkg_check_modules(OpenImageIO REQUIRED IMPORTED_TARGET GLOBAL OpenImageIO)
add_library(OpenImageIO::OpenImageIO ALIAS PkgConfig::OpenImageIO)

# Libraries of the service, found once, for every folder. What only one folder uses is found there.

find_package(Threads REQUIRED)
find_package(Protobuf REQUIRED)            # messages; module mode: Debian ships no CMake package for it
find_package(gRPC CONFIG REQUIRED)         # the transport of the first door
find_package(OpenImageIO CONFIG REQUIRED)  # pictures in every format, in memory
find_package(spdlog CONFIG REQUIRED)       # leveled logs without ceremony

# Debian's package names OpenCV's headers, which its users do not have and do not need.
get_target_property(oiio_includes OpenImageIO::OpenImageIO INTERFACE_INCLUDE_DIRECTORIES)
list(FILTER oiio_includes EXCLUDE REGEX "opencv")
set_target_properties(OpenImageIO::OpenImageIO PROPERTIES INTERFACE_INCLUDE_DIRECTORIES "${oiio_includes}")

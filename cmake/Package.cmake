# Debian packages by CPack: lpvd (with its service), lpvctl, lpvctl-images. deploy/package/build makes them.

set(from ${PROJECT_SOURCE_DIR}/deploy/package)
set(LPV_MAINTAINER "lpvd maintainers <lpvd@packages.debian.org>" CACHE STRING "Maintainer of the packages, NAME <MAIL>")
set(packages lpvd lpvctl lpvctl-images)

# lpv_package_file(COMPONENT FOLDER FILES...): in the package, and left out by a plain `cmake --install`.
function(lpv_package_file component folder)
  install(FILES ${ARGN} DESTINATION ${folder} COMPONENT ${component} EXCLUDE_FROM_ALL)
endfunction()

lpv_package_file(lpvd lib/systemd/system ${from}/lpvd.service)
lpv_package_file(lpvd lib/sysusers.d ${from}/sysusers/lpvd.conf)
lpv_package_file(lpvd share/doc/lpvd ${PROJECT_SOURCE_DIR}/deploy/METRICS.md)
lpv_package_file(lpvd_etc /etc/lpvd ${from}/lpvd.toml)

find_program(GZIP gzip REQUIRED)
foreach(package ${packages})
  string(REPLACE - _ component ${package})
  set(made ${CMAKE_CURRENT_BINARY_DIR}/package/${package})
  configure_file(${from}/changelog.in ${made}/changelog @ONLY)
  execute_process(COMMAND ${GZIP} -9nf ${made}/changelog COMMAND_ERROR_IS_FATAL ANY)
  lpv_package_file(${component} share/doc/${package} ${made}/changelog.gz ${from}/copyright)
endforeach()

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME lpvd)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "${LPV_MAINTAINER}")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_COMPONENTS_ALL lpvd lpvd_etc lpvctl lpvctl_images)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS
    OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ WORLD_EXECUTE)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)

set(CPACK_DEBIAN_SERVER_PACKAGE_NAME lpvd)
set(CPACK_DEBIAN_SERVER_PACKAGE_SECTION net)
set(CPACK_DEBIAN_SERVER_DESCRIPTION "The server: keeps light propagation volumes on a GPU, one per session.
Clients upload scenes and area lights of any shape over gRPC, move them, and
watch the room lit by them, as volumes or as rendered frames. Without a GPU it
runs on Mesa's software renderer.")
# Mesa is loaded by name, not linked: dpkg-shlibdeps cannot see it. The user is made by systemd-sysusers, which machines
# without systemd have as a package of its own.
set(CPACK_DEBIAN_SERVER_PACKAGE_DEPENDS
    "libgl1-mesa-dri, systemd | systemd-standalone-sysusers | systemd-sysusers")
set(CPACK_DEBIAN_SERVER_PACKAGE_SUGGESTS "haproxy, lpvctl, prometheus")
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_EXTRA ${from}/postinst ${from}/prerm ${from}/postrm ${from}/conffiles)
set(CPACK_DEBIAN_SERVER_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_COMMAND_PACKAGE_NAME lpvctl)
set(CPACK_DEBIAN_COMMAND_PACKAGE_SECTION net)
set(CPACK_DEBIAN_COMMAND_DESCRIPTION "The command line: creates sessions on an lpvd server, loads scenes from
glTF, OBJ, PLY and STL files, moves lights, and saves or watches what they
light.")
set(CPACK_DEBIAN_COMMAND_PACKAGE_RECOMMENDS lpvctl-images)

set(CPACK_DEBIAN_IMAGES_PACKAGE_NAME lpvctl-images)
set(CPACK_DEBIAN_IMAGES_PACKAGE_SECTION net)
set(CPACK_DEBIAN_IMAGES_DESCRIPTION "Textures for the command line: the module with which lpvctl reads the images
of textured scenes. It comes apart because OpenImageIO brings some 200
packages, which servers and health checks do without.")
set(CPACK_DEBIAN_IMAGES_PACKAGE_DEPENDS "lpvctl (= ${PROJECT_VERSION})")

include(CPack)
cpack_add_component(lpvd GROUP server)
cpack_add_component(lpvd_etc GROUP server)
cpack_add_component(lpvctl GROUP command)
cpack_add_component(lpvctl_images GROUP images)

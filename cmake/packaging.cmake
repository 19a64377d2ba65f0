# `make deb`: rfmvo-firmware (the box) and rfmvo-host (tools) as Debian packages.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_CONTACT "rfmvo developers <rfmvo@example.org>")
set(CPACK_PACKAGE_VENDOR rfmvo)
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_CMAKE_GENERATOR Ninja)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_ALL firmware host)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_RELEASE 1)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_PRIORITY optional)
# dpkg-shlibdeps knows the build machine's packages only: a cross build is told (RFMVO_DEB_DEPENDS).
if(CMAKE_CROSSCOMPILING)
  set(CPACK_DEBIAN_PACKAGE_ARCHITECTURE arm64)
  set(CPACK_DEBIAN_FIRMWARE_PACKAGE_DEPENDS "${RFMVO_FIRMWARE_DEPENDS}")
  set(CPACK_DEBIAN_HOST_PACKAGE_DEPENDS "${RFMVO_HOST_DEPENDS}")
else()
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
  set(CPACK_DEBIAN_FIRMWARE_PACKAGE_DEPENDS "iproute2, systemd")
endif()
set(CPACK_DEBIAN_FIRMWARE_PACKAGE_NAME rfmvo-firmware)
set(CPACK_DEBIAN_FIRMWARE_PACKAGE_RECOMMENDS chrony)
set(CPACK_COMPONENT_FIRMWARE_DESCRIPTION "rfmvod fuses the phases of an LLRP UHF RFID reader with monocular visual
odometry and publishes, over LCM, where every tag is and the metric scale of
its camera's path. With its systemd unit, user, udev and sysctl settings.")
set(CPACK_DEBIAN_HOST_PACKAGE_NAME rfmvo-host)
set(CPACK_DEBIAN_HOST_PACKAGE_RECOMMENDS gnuplot-nox)
set(CPACK_COMPONENT_HOST_DESCRIPTION "rfmvo replays, evaluates, simulates and reports journals of rfmvod, and is a
simulated RFID reader where there is none.")
set(CPACK_DEBIAN_FIRMWARE_PACKAGE_CONTROL_EXTRA
    ${PROJECT_SOURCE_DIR}/systemd/debian/postinst ${PROJECT_SOURCE_DIR}/systemd/debian/prerm
    ${PROJECT_SOURCE_DIR}/systemd/debian/postrm ${PROJECT_SOURCE_DIR}/systemd/debian/conffiles)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION TRUE)

# As Debian wants it: the changelog compressed, without a time stamp of its own.
set(changelog ${PROJECT_BINARY_DIR}/changelog.Debian)
configure_file(${PROJECT_SOURCE_DIR}/systemd/debian/changelog.in ${changelog} @ONLY)
execute_process(COMMAND gzip -9nkf ${changelog} COMMAND_ERROR_IS_FATAL ANY)

set(systemd ${PROJECT_SOURCE_DIR}/systemd)
install(FILES ${systemd}/rfmvod.service ${systemd}/rfmvo-multicast.service DESTINATION lib/systemd/system
        COMPONENT firmware)
install(FILES ${systemd}/rfmvo.sysusers DESTINATION lib/sysusers.d RENAME rfmvo.conf COMPONENT firmware)
install(FILES ${systemd}/rfmvo.sysctl DESTINATION lib/sysctl.d RENAME 60-rfmvo.conf COMPONENT firmware)
install(FILES ${systemd}/rfmvo.udev DESTINATION lib/udev/rules.d RENAME 60-rfmvo.rules COMPONENT firmware)
install(FILES ${systemd}/rfmvo.chrony DESTINATION /etc/chrony/conf.d RENAME rfmvo.conf COMPONENT firmware)
install(FILES ${systemd}/rfmvo.toml DESTINATION /etc/rfmvo COMPONENT firmware)
foreach(component firmware host)
  install(FILES ${changelog}.gz ${systemd}/debian/copyright DESTINATION share/doc/rfmvo-${component}
          COMPONENT ${component})
  install(FILES ${PROJECT_SOURCE_DIR}/README.md DESTINATION share/doc/rfmvo-${component} COMPONENT ${component})
endforeach()
include(CPack)

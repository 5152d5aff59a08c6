# cpack -G DEB: mdk-tools with the programs, libmdk-dev with the library.
set(CPACK_PACKAGE_NAME mdk)
set(CPACK_PACKAGE_VENDOR "The mdk authors")
set(CPACK_PACKAGE_CONTACT "The mdk authors <mdk@localhost>" CACHE STRING
  "Who answers for a package: name and address")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${CPACK_PACKAGE_CONTACT})
set(CPACK_COMPONENTS_ALL tools dev)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)

set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME mdk-tools)
set(CPACK_DEBIAN_TOOLS_DESCRIPTION "ray tracing of animated meshes by motion decomposition
 mdprep takes the motion of an animated mesh apart and writes one file of
 structures that hold at every time; mdview and mdprep render trace rays
 against it on the CPU. mdprep batch hands lists of such jobs to build farms.")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "ffmpeg, ninja-build, slurm-client, parallel")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libmdk-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS
  "libtbb-dev, libhwy-dev, libxxhash-dev, pkg-config, cmake")
set(CPACK_DEBIAN_DEV_DESCRIPTION "library to trace rays against animated meshes in .mdk files
 find_package(mdk) gives mdk::trace: load a file, set a time, intersect rays,
 each with its own time if wanted, from many threads.")

# What every Debian package has in its documentation folder.
configure_file(docs/packaging/changelog.in packaging/changelog @ONLY)
set(MDK_PACKAGE_NAMES mdk-tools libmdk-dev)
foreach(component package IN ZIP_LISTS CPACK_COMPONENTS_ALL MDK_PACKAGE_NAMES)
  install(FILES docs/packaging/copyright COMPONENT ${component}
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package})
  mdk_install_compressed(${component} ${CMAKE_INSTALL_DATADIR}/doc/${package}
    ${PROJECT_BINARY_DIR}/packaging/changelog)
endforeach()

include(CPack)

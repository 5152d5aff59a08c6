# cpack -G DEB: mdprep (for build farms: no window libraries), mdview, libmdk0, libmdk-dev and
# python3-mdk.
set(CPACK_PACKAGE_NAME mdk)
set(CPACK_PACKAGE_VENDOR "The mdk authors")
set(CPACK_PACKAGE_CONTACT "The mdk authors <mdk@localhost>" CACHE STRING
  "Who answers for a package: name and address")
set(CPACK_DEBIAN_PACKAGE_MAINTAINER ${CPACK_PACKAGE_CONTACT})
set(CPACK_COMPONENTS_ALL mdprep runtime dev)
set(MDK_PACKAGE_NAMES mdprep libmdk0 libmdk-dev)
if(MDK_BUILD_VIEWER)
  list(APPEND CPACK_COMPONENTS_ALL mdview)
  list(APPEND MDK_PACKAGE_NAMES mdview)
endif()
if(TARGET mdk_python)
  list(APPEND CPACK_COMPONENTS_ALL python)
  list(APPEND MDK_PACKAGE_NAMES python3-mdk)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_SECTION graphics)

set(CPACK_DEBIAN_MDPREP_PACKAGE_NAME mdprep)
set(CPACK_DEBIAN_MDPREP_DESCRIPTION "ray tracing of animated meshes by motion decomposition
 mdprep takes the motion of an animated mesh apart and writes one file of
 structures that hold at every time, renders it, checks it and measures it;
 mdprep batch hands lists of such jobs to build farms.")
set(CPACK_DEBIAN_MDPREP_PACKAGE_SUGGESTS "mdview, ffmpeg, ninja-build, slurm-client, parallel")
set(CPACK_DEBIAN_MDPREP_PACKAGE_REPLACES "mdk-tools")
set(CPACK_DEBIAN_MDPREP_PACKAGE_CONFLICTS "mdk-tools")

set(CPACK_DEBIAN_MDVIEW_PACKAGE_NAME mdview)
set(CPACK_DEBIAN_MDVIEW_PACKAGE_RECOMMENDS "mdprep")
set(CPACK_DEBIAN_MDVIEW_DESCRIPTION "viewer of ray traced animated meshes
 mdview maps what mdprep has written and ray traces every frame on the CPU:
 scrub, switch techniques live, see what each costs.")

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libmdk0)
set(CPACK_DEBIAN_RUNTIME_PACKAGE_SECTION libs)
set(CPACK_DEBIAN_RUNTIME_DESCRIPTION "rays against animated meshes, each at its own time
 The shared library, with a C interface: load or bake an animated mesh, and
 ask for hits, closest points and surfaces from many threads.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME libmdk-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_SHLIBDEPS OFF)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libmdk0 (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS
  "libtbb-dev, libhwy-dev, libxxhash-dev, libceres-dev, libeigen3-dev, pkg-config, cmake")
set(CPACK_DEBIAN_DEV_DESCRIPTION "rays against animated meshes: what compiles against libmdk
 mdk/mdk.h in C99 with libmdk.so (mdk::mdk in CMake, mdk in pkg-config), and
 static libraries in C++17, mdk::trace and mdk::bake, for those who have the
 suggested packages.")

set(CPACK_DEBIAN_PYTHON_PACKAGE_NAME python3-mdk)
set(CPACK_DEBIAN_PYTHON_PACKAGE_SECTION python)
set(CPACK_DEBIAN_PYTHON_PACKAGE_DEPENDS "python3 (>= 3.11), python3-numpy")
set(CPACK_DEBIAN_PYTHON_DESCRIPTION "rays against animated meshes, over NumPy arrays
 import mdk: load or bake an animated mesh, cast rays, each at its own time.")

# What every Debian package has in its documentation folder.
configure_file(docs/packaging/changelog.in packaging/changelog @ONLY)
foreach(component package IN ZIP_LISTS CPACK_COMPONENTS_ALL MDK_PACKAGE_NAMES)
  install(FILES docs/packaging/copyright COMPONENT ${component}
    DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${package})
  mdk_install_compressed(${component} ${CMAKE_INSTALL_DATADIR}/doc/${package}
    ${PROJECT_BINARY_DIR}/packaging/changelog)
endforeach()

include(CPack)

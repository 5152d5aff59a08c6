# cmake --install, by component: mdprep and mdview, each with its manual pages; "runtime", libmdk.so.0;
# "dev", what compiles and links against it, find_package(mdk) and mdk.pc; "python", the module.
# Nothing in the prefix knows where the prefix is.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS mdprep RUNTIME COMPONENT mdprep)
if(MDK_BUILD_VIEWER)
  install(TARGETS mdview RUNTIME COMPONENT mdview)
endif()

if(TARGET mdk_assimp)
  # Not a program that people start: mdprep looks for it here, beside the folder it is in itself.
  install(TARGETS mdk_assimp RUNTIME DESTINATION libexec/mdk COMPONENT mdprep)
endif()

# mdk_install_compressed(COMPONENT FOLDER PATTERN...): files as FOLDER/NAME.gz. gzip -n leaves name and
# time out: the same page gives the same bytes.
find_program(GZIP_PROGRAM gzip REQUIRED)
function(mdk_install_compressed component folder)
  install(CODE "
    file(GLOB files ${ARGN})
    set(folder \"\$ENV{DESTDIR}\${CMAKE_INSTALL_PREFIX}/${folder}\")
    foreach(file IN LISTS files)
      get_filename_component(name \${file} NAME)
      message(STATUS \"Installing: \${folder}/\${name}.gz\")
      file(MAKE_DIRECTORY \"\${folder}\")
      execute_process(COMMAND ${GZIP_PROGRAM} -9nc \"\${file}\" OUTPUT_FILE \"\${folder}/\${name}.gz\"
        COMMAND_ERROR_IS_FATAL ANY)
    endforeach()" COMPONENT ${component})
endfunction()
mdk_install_compressed(mdprep ${CMAKE_INSTALL_MANDIR}/man1 ${MDK_MANUAL_DIR}/*.1)
if(MDK_BUILD_VIEWER)
  mdk_install_compressed(mdview ${CMAKE_INSTALL_MANDIR}/man1 ${PROJECT_SOURCE_DIR}/docs/man/mdview.1)
endif()
install(FILES ${MDK_MANUAL_DIR}/mdprep.bash RENAME mdprep COMPONENT mdprep
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)

set(MDK_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/mdk)
# Three sets, since each asks for other packages: mdk::mdk for none, mdk::trace for what a static
# library is linked with, mdk::bake for what decomposes.
set_target_properties(mdk_shared PROPERTIES EXPORT_NAME mdk)
set_target_properties(mdk_core PROPERTIES EXPORT_NAME trace)
set_target_properties(mdk_bake PROPERTIES EXPORT_NAME bake)
install(TARGETS mdk_shared EXPORT mdk
  LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT runtime NAMELINK_COMPONENT dev)
install(TARGETS mdk_core EXPORT mdkTrace
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
install(TARGETS mdk_bake mdk_preprocess EXPORT mdkBake
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
file(RELATIVE_PATH MDK_PC_TO_INCLUDE /${CMAKE_INSTALL_LIBDIR}/pkgconfig /${CMAKE_INSTALL_INCLUDEDIR})
configure_file(cmake/mdk.pc.in ${PROJECT_BINARY_DIR}/mdk.pc @ONLY)
install(FILES ${PROJECT_BINARY_DIR}/mdk.pc COMPONENT dev
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
install(DIRECTORY common/include/mdk DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev
  FILES_MATCHING PATTERN "*.h")
install(FILES docs/library.md docs/ray-queries.md COMPONENT dev
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libmdk-dev)
install(DIRECTORY examples/ray_sweep examples/lidar COMPONENT dev
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libmdk-dev/examples)
foreach(set IN ITEMS mdk mdkTrace mdkBake)
  install(EXPORT ${set} NAMESPACE mdk:: FILE ${set}Targets.cmake DESTINATION ${MDK_CMAKE_DIR}
    COMPONENT dev)
endforeach()
configure_package_config_file(cmake/mdkConfig.cmake.in ${PROJECT_BINARY_DIR}/mdkConfig.cmake
  INSTALL_DESTINATION ${MDK_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mdkConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/mdkConfig.cmake ${PROJECT_BINARY_DIR}/mdkConfigVersion.cmake
  DESTINATION ${MDK_CMAKE_DIR} COMPONENT dev)

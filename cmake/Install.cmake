# cmake --install: programs, manual pages and completion (component "tools"), and the library for
# find_package(mdk) (component "dev"). Nothing in the prefix knows where the prefix is.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

install(TARGETS mdprep RUNTIME COMPONENT tools)
if(MDK_BUILD_VIEWER)
  install(TARGETS mdview RUNTIME COMPONENT tools)
  set(MDK_VIEWER_PAGES ${PROJECT_SOURCE_DIR}/docs/man/mdview.1)
endif()

if(TARGET mdk_assimp)
  # Not a program that people start: mdprep looks for it here, beside the folder it is in itself.
  install(TARGETS mdk_assimp RUNTIME DESTINATION libexec/mdk COMPONENT tools)
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
mdk_install_compressed(tools ${CMAKE_INSTALL_MANDIR}/man1 ${MDK_MANUAL_DIR}/*.1 ${MDK_VIEWER_PAGES})
install(FILES ${MDK_MANUAL_DIR}/mdprep.bash RENAME mdprep COMPONENT tools
  DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions)

set(MDK_CMAKE_DIR ${CMAKE_INSTALL_LIBDIR}/cmake/mdk)
set_target_properties(mdk_core PROPERTIES EXPORT_NAME trace)
install(TARGETS mdk_core EXPORT mdk ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev)
install(DIRECTORY common/include/mdk DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT dev
  FILES_MATCHING PATTERN "*.h")
install(FILES docs/ray-queries.md COMPONENT dev
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libmdk-dev)
install(DIRECTORY examples/ray_sweep COMPONENT dev
  DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/libmdk-dev/examples)
install(EXPORT mdk NAMESPACE mdk:: FILE mdkTargets.cmake DESTINATION ${MDK_CMAKE_DIR} COMPONENT dev)
configure_package_config_file(cmake/mdkConfig.cmake.in ${PROJECT_BINARY_DIR}/mdkConfig.cmake
  INSTALL_DESTINATION ${MDK_CMAKE_DIR})
write_basic_package_version_file(${PROJECT_BINARY_DIR}/mdkConfigVersion.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/mdkConfig.cmake ${PROJECT_BINARY_DIR}/mdkConfigVersion.cmake
  DESTINATION ${MDK_CMAKE_DIR} COMPONENT dev)

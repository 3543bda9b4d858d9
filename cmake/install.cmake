# cmake --install: bin/kdray, bin/kdray-bench beside it (which `kdray bench` starts; a package may leave it out), the modules as static libraries, the public headers, and the package that
# find_package(kdray) finds, with the target kdray::kdray. tests/consumer uses what is installed.
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package_dir ${CMAKE_INSTALL_LIBDIR}/cmake/kdray)
get_property(modules GLOBAL PROPERTY KDRAY_MODULES)

# What a user links: the API, and through it every module behind it.
add_library(kdray INTERFACE)
add_library(kdray::kdray ALIAS kdray)
target_link_libraries(kdray INTERFACE kdray::api)

install(TARGETS kdray ${modules} EXPORT kdray
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR}
        LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
        INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(DIRECTORY host/include/kdray DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
foreach(program kdray_cli kdray_bench_program)
  if(TARGET ${program})
    install(TARGETS ${program} RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR})
  endif()
endforeach()
if(TARGET kdray_bench_program)
  install(PROGRAMS bench/plot/kdray-bench-plot DESTINATION ${CMAKE_INSTALL_BINDIR})
endif()

if(TARGET kdray_mpi)
  install(TARGETS kdray_mpi LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}/kdray)
endif()
if(TARGET kdray_c)
  install(TARGETS kdray_c EXPORT kdray LIBRARY DESTINATION ${CMAKE_INSTALL_LIBDIR}
          INCLUDES DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  install(FILES host/include/kdray.h DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
  configure_file(cmake/kdray.pc.in ${PROJECT_BINARY_DIR}/kdray.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/kdray.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endif()
install(DIRECTORY examples/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/examples)

# Man pages and completions, where they could be made (kdray_papers).
install(DIRECTORY ${PROJECT_BINARY_DIR}/share/man/ DESTINATION ${CMAKE_INSTALL_MANDIR} OPTIONAL)
foreach(shell bash-completion zsh fish)
  install(DIRECTORY ${PROJECT_BINARY_DIR}/share/${shell} DESTINATION ${CMAKE_INSTALL_DATADIR} OPTIONAL)
endforeach()

# The program holds the kernels; as text they are there to be read, and to be changed under KDRAY_KERNEL_DIR.
install(DIRECTORY kernels/ DESTINATION ${CMAKE_INSTALL_DATADIR}/kdray/kernels
        FILES_MATCHING PATTERN "*.cl" PATTERN "*.clh" PATTERN "layout/*.h" PATTERN "primitives/*.h")
install(DIRECTORY scenes/ DESTINATION ${CMAKE_INSTALL_DATADIR}/kdray/scenes)
foreach(document README.md LICENSE CHANGELOG.md docs)
  if(IS_DIRECTORY ${PROJECT_SOURCE_DIR}/${document})
    install(DIRECTORY ${document}/ DESTINATION ${CMAKE_INSTALL_DOCDIR}/${document})
  elseif(EXISTS ${PROJECT_SOURCE_DIR}/${document})
    install(FILES ${document} DESTINATION ${CMAKE_INSTALL_DOCDIR})
  endif()
endforeach()

install(EXPORT kdray NAMESPACE kdray:: FILE kdrayTargets.cmake DESTINATION ${package_dir})
configure_package_config_file(cmake/kdrayConfig.cmake.in ${PROJECT_BINARY_DIR}/kdrayConfig.cmake
                              INSTALL_DESTINATION ${package_dir})
# Before 1.0 a minor version may change the interface.
write_basic_package_version_file(${PROJECT_BINARY_DIR}/kdrayConfigVersion.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${PROJECT_BINARY_DIR}/kdrayConfig.cmake ${PROJECT_BINARY_DIR}/kdrayConfigVersion.cmake
        DESTINATION ${package_dir})

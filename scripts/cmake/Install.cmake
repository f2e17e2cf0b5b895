# What "cmake --install" puts where: programs, the library of the file format, Python scripts, manual pages, samples, texts.
# Below share/iga-trimmed-solids the folders stand to each other as in the sources, so that the scripts find their way.
# Components: programs, cad (igaprep-cad alone, the only one that needs OpenCASCADE), dev (headers and static libraries).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(iga_data ${CMAKE_INSTALL_DATADIR}/${PROJECT_NAME})

install(TARGETS igaprep igasolve RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
if(TARGET igaprep-cad)
  install(TARGETS igaprep-cad RUNTIME DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT cad)
endif()

# Scripts. A link stands for iga, so that Python finds the package beside the script that the link leads to.
install(PROGRAMS scripts/iga scripts/export_lsdyna.py scripts/export_mesh.py scripts/plot.py scripts/render.py
        DESTINATION ${iga_data}/scripts COMPONENT programs)
install(DIRECTORY scripts/igatools DESTINATION ${iga_data}/scripts COMPONENT programs PATTERN __pycache__ EXCLUDE)
install(DIRECTORY schema DESTINATION ${iga_data} COMPONENT programs)
file(RELATIVE_PATH launcher /${CMAKE_INSTALL_BINDIR} /${iga_data}/scripts/iga)
file(MAKE_DIRECTORY ${CMAKE_CURRENT_BINARY_DIR}/links)
file(CREATE_LINK ${launcher} ${CMAKE_CURRENT_BINARY_DIR}/links/iga SYMBOLIC)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/links/iga DESTINATION ${CMAKE_INSTALL_BINDIR} COMPONENT programs)
# Debian's Python looks into /usr/lib/python3/dist-packages.
file(CREATE_LINK ../../../${iga_data}/scripts/igatools ${CMAKE_CURRENT_BINARY_DIR}/links/igatools SYMBOLIC)
install(CODE "if(CMAKE_INSTALL_PREFIX MATCHES \"/usr$\")
  file(INSTALL DESTINATION \"\${CMAKE_INSTALL_PREFIX}/lib/python3/dist-packages\" TYPE FILE
       FILES \"${CMAKE_CURRENT_BINARY_DIR}/links/igatools\")
endif()" COMPONENT programs)

# Samples: their paths into the build folder lead to samples/parts instead.
set(installed_samples ${CMAKE_CURRENT_BINARY_DIR}/installed_samples)
install(CODE "execute_process(COMMAND \"${CMAKE_COMMAND}\" -DSOURCES=${CMAKE_SOURCE_DIR}/samples -DPARTS=${CMAKE_BINARY_DIR}/samples
  -DOUTPUT=${installed_samples} -P \"${CMAKE_SOURCE_DIR}/scripts/cmake/InstalledSamples.cmake\" COMMAND_ERROR_IS_FATAL ANY)"
  COMPONENT programs)
install(DIRECTORY ${installed_samples}/ DESTINATION ${iga_data}/samples COMPONENT programs
        USE_SOURCE_PERMISSIONS)

install(FILES README.md CHANGELOG.md DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT programs)
install(FILES LICENSE DESTINATION ${CMAKE_INSTALL_DOCDIR} COMPONENT licence) # Debian has the GPL: no package takes it along
foreach(folder format preprocessor solver solver/explicit)
  install(FILES ${folder}/README.md DESTINATION ${CMAKE_INSTALL_DOCDIR}/${folder} COMPONENT programs)
endforeach()

# The library: find_package(iga_trimmed_solids) and pkg-config.
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/iga_trimmed_solids)
set_target_properties(iga_model PROPERTIES EXPORT_NAME model)
set_target_properties(iga_io PROPERTIES EXPORT_NAME io)
install(TARGETS iga_model iga_io EXPORT iga_trimmed_solids
        ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT dev
        FILE_SET HEADERS DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/${PROJECT_NAME} COMPONENT dev)
install(EXPORT iga_trimmed_solids NAMESPACE iga:: FILE iga_trimmed_solids-targets.cmake
        DESTINATION ${package_folder} COMPONENT dev)
configure_package_config_file(scripts/cmake/iga_trimmed_solids-config.cmake.in iga_trimmed_solids-config.cmake
                              INSTALL_DESTINATION ${package_folder} NO_SET_AND_CHECK_MACRO)
write_basic_package_version_file(iga_trimmed_solids-config-version.cmake COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/iga_trimmed_solids-config.cmake
              ${CMAKE_CURRENT_BINARY_DIR}/iga_trimmed_solids-config-version.cmake
        DESTINATION ${package_folder} COMPONENT dev)

# pkg-config: HDF5 has no package file of its own name on every system, so the library found here is named.
list(GET HDF5_LIBRARIES 0 hdf5_library)
cmake_path(GET hdf5_library PARENT_PATH IGA_HDF5_FOLDER)
cmake_path(GET hdf5_library STEM IGA_HDF5_NAME)
string(REGEX REPLACE "^lib" "" IGA_HDF5_NAME ${IGA_HDF5_NAME})
file(RELATIVE_PATH IGA_PREFIX_FROM_PC /${CMAKE_INSTALL_LIBDIR}/pkgconfig /)
configure_file(scripts/cmake/iga-trimmed-solids.pc.in iga-trimmed-solids.pc @ONLY)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/iga-trimmed-solids.pc DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig COMPONENT dev)

# Debian packages by CPack: scripts/package, or "cpack" in a build folder.
#   iga-trimmed-solids       programs, scripts, samples, manual pages
#   iga-trimmed-solids-cad   igaprep-cad, which brings OpenCASCADE with it
#   iga-trimmed-solids-dev   headers and static libraries of the file format
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME ${PROJECT_NAME})
set(CPACK_PACKAGE_VERSION ${PROJECT_VERSION})
set(CPACK_PACKAGE_CONTACT "The maintainers of iga-trimmed-solids <maintainers@iga-trimmed-solids.invalid>")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulation of trimmed spline solids straight from CAD")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_PACKAGE_DIRECTORY ${CMAKE_SOURCE_DIR}/build/package CACHE PATH "Folder of the packages that cpack makes")
set(CPACK_STRIP_FILES ON)
set(CPACK_INSTALL_DEFAULT_DIRECTORY_PERMISSIONS OWNER_READ OWNER_WRITE OWNER_EXECUTE GROUP_READ GROUP_EXECUTE WORLD_READ
    WORLD_EXECUTE)

set(CPACK_COMPONENTS_ALL programs dev)
if(TARGET igaprep-cad)
  list(APPEND CPACK_COMPONENTS_ALL cad)
endif()
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_COMPONENTS_GROUPING ONE_PER_GROUP)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)
set(CPACK_DEBIAN_COMPRESSION_TYPE xz)

set(iga_same_version "${PROJECT_NAME} (= ${PROJECT_VERSION})")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_NAME ${PROJECT_NAME})
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_DEPENDS "python3 (>= 3.11), python3-h5py, python3-numpy, python3-scipy")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_RECOMMENDS "${PROJECT_NAME}-cad (= ${PROJECT_VERSION}), libjs-three, python3-matplotlib")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_SUGGESTS "${PROJECT_NAME}-dev, paraview, python3-paraview, xvfb, hdf5-tools")
set(CPACK_DEBIAN_PROGRAMS_PACKAGE_CONTROL_EXTRA "${CMAKE_SOURCE_DIR}/scripts/cmake/debian/postinst"
    "${CMAKE_SOURCE_DIR}/scripts/cmake/debian/prerm")
set(CPACK_DEBIAN_PROGRAMS_DESCRIPTION "A part is embedded in a regular B-spline grid and trimmed exactly, so there is
no mesh to make.

igaprep reads a surface (STL, OBJ, PLY, OFF) and writes a model, one HDF5 file.
igasolve computes vibration modes, stable time steps, displacements and
stresses under loads, impact and crush with contact. iga does both and refines
the grid until the results are as accurate as asked for. The Python package
igatools reads models and results.")

set(CPACK_DEBIAN_CAD_PACKAGE_NAME ${PROJECT_NAME}-cad)
set(CPACK_DEBIAN_CAD_PACKAGE_SECTION science)
set(CPACK_DEBIAN_CAD_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_CAD_PACKAGE_DEPENDS ${iga_same_version})
set(CPACK_DEBIAN_CAD_DESCRIPTION "With this package igaprep reads STEP, IGES and BREP files as well. It is a
package of its own because it brings OpenCASCADE with it.")

set(CPACK_DEBIAN_DEV_PACKAGE_NAME ${PROJECT_NAME}-dev)
set(CPACK_DEBIAN_DEV_PACKAGE_SECTION libdevel)
set(CPACK_DEBIAN_DEV_PACKAGE_DEPENDS "libfmt-dev, libhdf5-dev, libssl-dev, libtbb-dev, zlib1g-dev")
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS ${iga_same_version})
set(CPACK_DEBIAN_DEV_DESCRIPTION "Headers and static libraries that read, check and write models and results in
C++, with package files for CMake and pkg-config.")

# What Debian expects in a package's folder of documents.
string(TIMESTAMP date "%a, %d %b %Y %H:%M:%S +0000" UTC)
file(WRITE ${CMAKE_CURRENT_BINARY_DIR}/changelog "${PROJECT_NAME} (${PROJECT_VERSION}) unstable; urgency=medium

  * Changes are told in CHANGELOG.md.

 -- ${CPACK_PACKAGE_CONTACT}  ${date}
")
execute_process(COMMAND gzip -9nf ${CMAKE_CURRENT_BINARY_DIR}/changelog COMMAND_ERROR_IS_FATAL ANY)
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} name)
  install(FILES scripts/cmake/debian/copyright ${CMAKE_CURRENT_BINARY_DIR}/changelog.gz COMPONENT ${component} EXCLUDE_FROM_ALL
          DESTINATION ${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${name}_PACKAGE_NAME})
endforeach()
include(CPack)

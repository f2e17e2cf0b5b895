# Copies the samples for an installation. In the sources their parts and models lie in the build folder; there they lie in
# the folder parts beside the samples, and the programs on the PATH.
# usage: cmake -DSOURCES=samples -DPARTS=build/release/samples -DOUTPUT=folder -P InstalledSamples.cmake
file(REMOVE_RECURSE ${OUTPUT})
file(GLOB_RECURSE files RELATIVE ${SOURCES} ${SOURCES}/*.md ${SOURCES}/*.toml ${SOURCES}/*.csv ${SOURCES}/*.stl
     ${SOURCES}/*.step ${SOURCES}/*.png ${SOURCES}/results_in_python/*.py)
list(FILTER files EXCLUDE REGEX "^(11_foam_modes_vs_fem|elastic_wave)/") # run by scripts that stay with the sources
foreach(file IN LISTS files)
  if(file MATCHES "\\.(md|toml)$")
    file(READ ${SOURCES}/${file} text)
    string(REGEX REPLACE "\\.\\./\\.\\./build/(release/samples|[a-z_]+)" "../parts" text "${text}")
    string(REPLACE "PYTHONPATH=scripts FILES=build/release/samples" "FILES=samples/parts" text "${text}")
    string(REPLACE "build/release/samples/" "samples/parts/" text "${text}")
    string(REPLACE "build/release/bin/" "" text "${text}")
    string(REPLACE "   # from the target sample_parts" "" text "${text}")
    file(WRITE ${OUTPUT}/${file} "${text}")
  else()
    cmake_path(GET file PARENT_PATH folder)
    file(COPY ${SOURCES}/${file} DESTINATION ${OUTPUT}/${folder})
  endif()
endforeach()
file(MAKE_DIRECTORY ${OUTPUT}/parts)
file(GLOB parts ${PARTS}/*.stl)
file(COPY ${parts} DESTINATION ${OUTPUT}/parts)

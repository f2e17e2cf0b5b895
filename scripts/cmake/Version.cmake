# Writes a source file that says which program this is, down to the commit it was built from, so that files made by
# another build are told apart. Run at every build; the file changes only when the answer does.
#   0.1.0+g1a2b3c4d                 built from this commit
#   0.1.0+g1a2b3c4d.dirty.5e6f7a8b  with changes; the last part is a hash of the sources
#   0.1.0+s5e6f7a8b                 from sources without git
# usage: cmake -DSOURCE_DIR=… -DVERSION=0.1.0 -DOUTPUT=version.cpp -P Version.cmake
set(product CMakeLists.txt format preprocessor solver scripts/cmake) # what the programs are made of

execute_process(COMMAND git rev-parse --short=8 HEAD WORKING_DIRECTORY ${SOURCE_DIR}
                OUTPUT_VARIABLE commit OUTPUT_STRIP_TRAILING_WHITESPACE RESULT_VARIABLE no_git ERROR_QUIET)
execute_process(COMMAND git rev-parse --show-toplevel WORKING_DIRECTORY ${SOURCE_DIR}
                OUTPUT_VARIABLE top OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
get_filename_component(source ${SOURCE_DIR} REALPATH)
set(changes "")
if(no_git EQUAL 0 AND "${top}" STREQUAL "${source}") # not some repository that these sources merely lie in
  set(mark "g${commit}")
  execute_process(COMMAND git status --porcelain -- ${product} WORKING_DIRECTORY ${SOURCE_DIR} OUTPUT_VARIABLE changes)
else()
  set(mark "")
endif()

if(mark STREQUAL "" OR NOT changes STREQUAL "")
  set(hashes "")
  foreach(part IN LISTS product)
    if(IS_DIRECTORY ${SOURCE_DIR}/${part})
      file(GLOB_RECURSE files RELATIVE ${SOURCE_DIR} ${SOURCE_DIR}/${part}/*.?pp ${SOURCE_DIR}/${part}/CMakeLists.txt
           ${SOURCE_DIR}/${part}/*.cmake)
    else()
      set(files ${part})
    endif()
    list(SORT files)
    foreach(file IN LISTS files)
      file(SHA256 ${SOURCE_DIR}/${file} hash)
      string(APPEND hashes "${file} ${hash}\n")
    endforeach()
  endforeach()
  string(SHA256 hash "${hashes}")
  string(SUBSTRING ${hash} 0 8 hash)
  if(mark STREQUAL "")
    set(mark "s${hash}")
  else()
    string(APPEND mark ".dirty.${hash}")
  endif()
endif()

set(text "// Made by scripts/cmake/Version.cmake.\n#include \"format/model/version.hpp\"\n\n")
string(APPEND text "const char* iga::program_version() {\n  return \"${VERSION}+${mark}\";\n}\n")
set(before "")
if(EXISTS ${OUTPUT})
  file(READ ${OUTPUT} before)
endif()
if(NOT before STREQUAL text)
  file(WRITE ${OUTPUT} "${text}")
endif()

# Manual pages and completions for bash, made from what the built programs print with --help.
if(IGA_FUZZ OR IGA_SANITIZE OR NOT IGA_PYTHON)
  return()
endif()
execute_process(COMMAND ${IGA_PYTHON} -c "import h5py, numpy, scipy" RESULT_VARIABLE missing ERROR_QUIET OUTPUT_QUIET)
if(missing)
  message(STATUS "Python's h5py, numpy or scipy was not found: no manual pages. On Debian: apt-get install python3-h5py python3-scipy")
  return()
endif()

set(programs igaprep igasolve)
if(TARGET igaprep-cad)
  list(APPEND programs igaprep-cad)
endif()
set(paths ${CMAKE_SOURCE_DIR}/scripts/iga)
foreach(program IN LISTS programs)
  list(APPEND paths $<TARGET_FILE:${program}>)
endforeach()
set(IGA_MANUAL ${CMAKE_BINARY_DIR}/manual)
set(pages "")
foreach(program iga ${programs})
  list(APPEND pages ${IGA_MANUAL}/man1/${program}.1)
endforeach()
file(GLOB sources CONFIGURE_DEPENDS scripts/manual/*.py scripts/igatools/driver/*.py)
add_custom_command(OUTPUT ${pages}
  COMMAND ${CMAKE_COMMAND} -E env PYTHONDONTWRITEBYTECODE=1 ${IGA_PYTHON} ${CMAKE_SOURCE_DIR}/scripts/manual/make_manual.py
          --output ${IGA_MANUAL} --version ${PROJECT_VERSION} ${paths}
  DEPENDS ${programs} scripts/iga ${sources}
  COMMENT "Writing manual pages and completions")
add_custom_target(manual ALL DEPENDS ${pages})

foreach(program iga ${programs})
  set(component programs)
  if(program STREQUAL igaprep-cad)
    set(component cad)
  endif()
  install(FILES ${IGA_MANUAL}/man1/${program}.1.gz DESTINATION ${CMAKE_INSTALL_MANDIR}/man1 COMPONENT ${component})
  install(FILES ${IGA_MANUAL}/completions/${program} DESTINATION ${CMAKE_INSTALL_DATADIR}/bash-completion/completions
          COMPONENT ${component})
endforeach()

# Installs flotsam, then configures, builds and runs a program of somebody else against the installed tree.
# -DSTEP=install|build|run|wrong_precision, and where things are: FLOTSAM_BUILD, PROJECT, WORK, CONFIGURE_ARGS

set(stage ${WORK}/stage)
set(build ${WORK}/build)

function(run)
  execute_process(COMMAND ${ARGN} COMMAND_ECHO STDOUT COMMAND_ERROR_IS_FATAL ANY)
endfunction()

if(STEP STREQUAL install)
  file(REMOVE_RECURSE ${WORK})
  run(${CMAKE_COMMAND} --install ${FLOTSAM_BUILD} --prefix ${stage})
elseif(STEP STREQUAL build)
  run(${CMAKE_COMMAND} -S ${PROJECT} -B ${build} -DCMAKE_PREFIX_PATH=${stage} ${CONFIGURE_ARGS})
  run(${CMAKE_COMMAND} --build ${build})
elseif(STEP STREQUAL run)
  run(${build}/without_bullet)
  run(${build}/floating_box)
  if(EXISTS ${stage}/bin/flotsam)
    run(${stage}/bin/flotsam --help)
  endif()
elseif(STEP STREQUAL wrong_precision)
  execute_process(COMMAND ${CMAKE_COMMAND} --build ${build} --target wrong_precision
                  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE output)
  message(STATUS "${output}")
  if(status EQUAL 0)
    message(FATAL_ERROR "a program compiled for the other precision of Bullet was linked")
  elseif(NOT output MATCHES "undefined reference to [^\n]*bullet_(single|double)")
    message(FATAL_ERROR "it failed, but not because of the symbol that guards the precision")
  endif()
endif()

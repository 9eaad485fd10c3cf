# Installs the build into a fresh prefix, builds tests/consumer against it, runs it and reads what it prints.
#   cmake -D BUILD=... -D GENERATOR=... -D COMPILER=... [-D LAUNCHER=...] -P install_and_use.cmake
set(work ${BUILD}/tests/consumer)
set(prefix ${work}/prefix)
file(REMOVE_RECURSE ${work})

execute_process(COMMAND ${CMAKE_COMMAND} --install ${BUILD} --prefix ${prefix} OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${prefix}/bin/whirl --help OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
execute_process(
  COMMAND ${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR} -B ${work}/build -G ${GENERATOR} -DCMAKE_PREFIX_PATH=${prefix} -DCMAKE_BUILD_TYPE=Release
          -DCMAKE_CXX_COMPILER=${COMPILER} -DCMAKE_CXX_COMPILER_LAUNCHER=${LAUNCHER}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${work}/build COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${work}/build/fold OUTPUT_VARIABLE printed COMMAND_ERROR_IS_FATAL ANY)
message("${printed}")

# Folds at mu = -+2 / (3 sqrt 3) = -+0.3849001794597...; the cable is the stay of studies/oresund-superharmonic.toml.
foreach(expected "fold at mu = -0.384900179" "fold at mu = 0.384900179" "lambda2 = [0-9]+\\.[0-9]+, 0 warnings")
  if(NOT printed MATCHES "${expected}")
    message(FATAL_ERROR "the program did not print: ${expected}")
  endif()
endforeach()

# Writes the manual (gzipped, as Debian keeps it) and the completion of shells: cmake -D PROGRAM=… -D FOLDER=… -P
cmake_minimum_required(VERSION 3.25)
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/man ${FOLDER}/completion)
execute_process(COMMAND ${PROGRAM} help --man ${FOLDER}/man OUTPUT_QUIET COMMAND_ERROR_IS_FATAL ANY)
file(GLOB pages ${FOLDER}/man/*.1)
execute_process(COMMAND gzip -9n ${pages} COMMAND_ERROR_IS_FATAL ANY)
foreach(shell_and_file bash/rayfield zsh/_rayfield fish/rayfield.fish)
  cmake_path(GET shell_and_file PARENT_PATH shell)
  cmake_path(GET shell_and_file FILENAME file)
  execute_process(COMMAND ${PROGRAM} completion ${shell} OUTPUT_FILE ${FOLDER}/completion/${file}
    COMMAND_ERROR_IS_FATAL ANY)
endforeach()
file(TOUCH ${FOLDER}/done)

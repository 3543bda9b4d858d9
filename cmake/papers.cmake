# cmake -DPROGRAM=FILE -DSHARE=DIR -P papers.cmake: writes the man pages of kdray or kdray-bench below DIR, and kdray's
# completions, at the places where man and the shells look for them below a prefix.
function(ask)
  execute_process(COMMAND ${PROGRAM} ${ARGN} COMMAND_ERROR_IS_FATAL ANY)
endfunction()

file(MAKE_DIRECTORY ${SHARE}/man/man1)
ask(--man ${SHARE}/man/man1)
cmake_path(GET PROGRAM STEM program)
if(program STREQUAL "kdray")
  foreach(folder bash-completion/completions zsh/site-functions fish/vendor_completions.d)
    file(MAKE_DIRECTORY ${SHARE}/${folder})
  endforeach()
  ask(--completion bash OUTPUT_FILE ${SHARE}/bash-completion/completions/kdray)
  ask(--completion zsh OUTPUT_FILE ${SHARE}/zsh/site-functions/_kdray)
  ask(--completion fish OUTPUT_FILE ${SHARE}/fish/vendor_completions.d/kdray.fish)
endif()

# selvage_version(OUT ROOT RELEASE): the version of the sources in ROOT. By the last tag `v...` of their own git repository, "0.2.0";
# n commits after it "0.2.0+n.gHASH". RELEASE, the project's own, where there is no such tag, no repository or no git.
function(selvage_version out root release)
  set(version ${release})
  find_program(GIT git)
  if(GIT)
    # Of a repository round ROOT that is not its own no tag counts.
    get_filename_component(above "${root}" DIRECTORY)
    execute_process(
      COMMAND ${CMAKE_COMMAND} -E env "GIT_CEILING_DIRECTORIES=${above}" ${GIT} -C "${root}" describe --tags --match "v[0-9]*"
      RESULT_VARIABLE failed OUTPUT_VARIABLE described ERROR_QUIET OUTPUT_STRIP_TRAILING_WHITESPACE)
    if(NOT failed AND described MATCHES "^v(.+)-([0-9]+)-(g[0-9a-f]+)$")
      set(version "${CMAKE_MATCH_1}+${CMAKE_MATCH_2}.${CMAKE_MATCH_3}")
    elseif(NOT failed AND described MATCHES "^v(.+)$")
      set(version "${CMAKE_MATCH_1}")
    endif()
  endif()
  set(${out} ${version} PARENT_SCOPE)
endfunction()

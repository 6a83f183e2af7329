# With KLUFT_UNITY the C++ sources of one folder are compiled together: the headers, which take most of the time, are
# read once. What stands in the unnamed namespaces of a folder therefore has distinct names.
function(kluft_unity target)
  if(NOT KLUFT_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_filename_component(folder ${source} DIRECTORY)
    get_filename_component(folder ${folder} NAME)
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

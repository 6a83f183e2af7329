# With KLUFT_UNITY the C++ sources of one folder are compiled in batches: the headers, which take most of the time, are
# read once for each. What stands in the unnamed namespaces of a folder therefore has distinct names.
# Sources in a batch: large enough to save most of the time, small enough that all cores have work to the end.
set(KLUFT_UNITY_BATCH 12)

function(kluft_unity target)
  if(NOT KLUFT_UNITY)
    return()
  endif()
  get_target_property(sources ${target} SOURCES)
  foreach(source IN LISTS sources)
    get_filename_component(folder ${source} DIRECTORY)
    get_filename_component(folder ${folder} NAME)
    if(NOT DEFINED n_${folder})
      set(n_${folder} 0)
    endif()
    math(EXPR batch "${n_${folder}} / ${KLUFT_UNITY_BATCH}")
    math(EXPR n_${folder} "${n_${folder}} + 1")
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${folder}_${batch})
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
endfunction()

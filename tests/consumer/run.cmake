# Installs Pagoda into a fresh prefix, builds the consumer against it and opens a database with it.
#   cmake -DPAGODA_BUILD=... -DCOMPONENTS=... -DCXX=... -DFLAGS=... -DFOLDER=... -P run.cmake
function(run)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE result OUTPUT_VARIABLE output ERROR_VARIABLE output)
  if(NOT result EQUAL 0)
    message(FATAL_ERROR "${ARGN}\nended with ${result}:\n${output}")
  endif()
  set(output "${output}" PARENT_SCOPE)
endfunction()

file(REMOVE_RECURSE ${FOLDER})
run(${CMAKE_COMMAND} --install ${PAGODA_BUILD} --prefix ${FOLDER}/prefix)

# What is installed must not know where it was built.
file(GLOB_RECURSE packages ${FOLDER}/prefix/*.cmake)
foreach(file IN LISTS packages)
  file(READ ${file} text)
  if(text MATCHES "${PAGODA_SOURCE}" OR text MATCHES "${PAGODA_BUILD}")
    message(FATAL_ERROR "${file} names the folder it was built in")
  endif()
endforeach()

run(${CMAKE_COMMAND} -S ${CMAKE_CURRENT_LIST_DIR}/project -B ${FOLDER}/build
  -DCMAKE_PREFIX_PATH=${FOLDER}/prefix -DCMAKE_CXX_COMPILER=${CXX} "-DCMAKE_CXX_FLAGS=${FLAGS}"
  "-DPAGODA_COMPONENTS=${COMPONENTS}")
run(${CMAKE_COMMAND} --build ${FOLDER}/build)

file(WRITE ${FOLDER}/tetrahedron.obj
  "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
run(${FOLDER}/prefix/bin/pagoda --quiet build ${FOLDER}/tetrahedron.obj -o ${FOLDER}/t.pagoda)
run(${FOLDER}/build/consumer ${FOLDER}/t.pagoda)
if(NOT output STREQUAL "4 triangles\n")
  message(FATAL_ERROR "the consumer printed '${output}' instead of '4 triangles'")
endif()

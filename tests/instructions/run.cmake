# Counts the instructions of Environment::advance() per particle-step, exactly, and holds them under a bound: at most 2% above
# what is measured, so that a loss shows. The bounds hold for g++ 12 with -O3: which functions it inlines decides some of them.
foreach(kind_and_bound still=274 moving=751 lattice=1890 long=2849 long_moving=8205 plane=261 plane_moving=385 corner=12145)
  string(REGEX MATCH "(.*)=(.*)" ignored ${kind_and_bound})
  set(kind ${CMAKE_MATCH_1})
  set(bound ${CMAKE_MATCH_2})
  execute_process(
    COMMAND ${VALGRIND} --tool=callgrind --callgrind-out-file=/dev/null "--toggle-collect=dartcast::Environment::advance(*" ${PROGRAM} ${kind}
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE log)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${kind}: ${output}${log}")
  endif()
  string(REGEX MATCH "([0-9]+) particle-steps" ignored "${output}")
  set(steps ${CMAKE_MATCH_1})
  string(REGEX MATCH "Collected : ([0-9]+)" ignored "${log}")
  math(EXPR each "${CMAKE_MATCH_1} / ${steps}")
  message(STATUS "${kind}: ${each} instructions per particle-step, at most ${bound}; ${output}")
  if(each GREATER bound OR each LESS 50)
    set(wrong "${wrong} ${kind}")
  endif()
endforeach()

# Steps with forces against one with a constant drag.
foreach(kind drag forces brownian)
  execute_process(
    COMMAND ${VALGRIND} --tool=callgrind --callgrind-out-file=/dev/null "--toggle-collect=dartcast::Simulation::step(*" ${PROGRAM} ${kind}
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE log)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "${kind}: ${output}${log}")
  endif()
  string(REGEX MATCH "([0-9]+) particle-steps" ignored "${output}")
  set(steps ${CMAKE_MATCH_1})
  string(REGEX MATCH "Collected : ([0-9]+)" ignored "${log}")
  math(EXPR ${kind} "${CMAKE_MATCH_1} / ${steps}")
  message(STATUS "${kind}: ${${kind}} instructions per particle-step")
endforeach()
math(EXPR allowed "${drag} * 5 / 2")
if(forces GREATER allowed OR brownian GREATER allowed OR drag LESS 50)
  set(wrong "${wrong} forces")
endif()

# Edits touch a few cells, however many there are: 40 of them after the first 10, which list cells and particles once.
function(count_edits edge count into)
  list(TRANSFORM ARGN REPLACE "(.+)" "--toggle-collect=dartcast::Environment::\\1(*")
  execute_process(
    COMMAND ${VALGRIND} --tool=callgrind --callgrind-out-file=/dev/null ${ARGN} ${PROGRAM} edits ${edge} ${count}
    RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE log)
  if(NOT status EQUAL 0)
    message(FATAL_ERROR "edits: ${output}${log}")
  endif()
  string(REGEX MATCH "Collected : ([0-9]+)" ignored "${log}")
  set(${into} ${CMAKE_MATCH_1} PARENT_SCOPE)
endfunction()
foreach(edge 10 24)
  count_edits(${edge} 10 few edit update_after_edit)
  count_edits(${edge} 50 many edit update_after_edit)
  math(EXPR each_${edge} "(${many} - ${few}) / 40")
  math(EXPR cells "${edge} * ${edge} * ${edge}")
  message(STATUS "edits: ${each_${edge}} instructions each among ${cells} cells")
endforeach()
# A function that was renamed would be left out without a word.
foreach(function edit update_after_edit)
  count_edits(10 50 some ${function})
  if(some LESS 50000)
    set(wrong "${wrong} ${function}")
  endif()
endforeach()
math(EXPR allowed "${each_10} * 13 / 10")
if(each_24 GREATER allowed OR each_10 GREATER 393000 OR each_10 LESS 1000)
  set(wrong "${wrong} edits")
endif()
# One cut, in millions.
execute_process(
  COMMAND ${VALGRIND} --tool=callgrind --callgrind-out-file=/dev/null "--toggle-collect=dartcast::Environment::edit(*" ${PROGRAM} cut
  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE log)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "cut: ${output}${log}")
endif()
string(REGEX MATCH "Collected : ([0-9]+)" ignored "${log}")
math(EXPR millions "${CMAKE_MATCH_1} / 1000000")
message(STATUS "cut: ${millions} million instructions; ${output}")
if(millions GREATER 30 OR millions LESS 1)
  set(wrong "${wrong} cut")
endif()
# A walk that goes to another rank: packed there, and unpacked here.
execute_process(
  COMMAND ${VALGRIND} --tool=callgrind --callgrind-out-file=/dev/null "--toggle-collect=dartcast::pack(*" "--toggle-collect=dartcast::unpack(*"
          ${PROGRAM} travel
  RESULT_VARIABLE status OUTPUT_VARIABLE output ERROR_VARIABLE log)
if(NOT status EQUAL 0)
  message(FATAL_ERROR "travel: ${output}${log}")
endif()
string(REGEX MATCH "([0-9]+) travellers" ignored "${output}")
set(travellers ${CMAKE_MATCH_1})
string(REGEX MATCH "Collected : ([0-9]+)" ignored "${log}")
math(EXPR each "${CMAKE_MATCH_1} / ${travellers}")
message(STATUS "travel: ${each} instructions each; ${output}")
if(each GREATER 325 OR each LESS 50)
  set(wrong "${wrong} travel")
endif()
if(wrong)
  message(FATAL_ERROR "more instructions than allowed, or fewer than there can be:${wrong}")
endif()

# Writes the page, with its style and scripts put in, as a C++ string.
# usage: cmake -D OUT=report_page.cpp -D "D3=a.min.js;b.min.js" -P embed.cmake
set(folder ${CMAKE_CURRENT_LIST_DIR})
file(READ ${folder}/page.html page)
string(REGEX MATCHALL "{{[a-z]+[.](css|js)}}|{{D3_LICENSE}}" places "${page}")
foreach(place ${places})
    string(REGEX REPLACE "[{}]" "" name ${place})
    file(READ ${folder}/${name} text)
    string(REPLACE ${place} "${text}" page "${page}")
endforeach()
set(scripts "")
foreach(file ${D3})
    file(READ ${file} text)
    string(APPEND scripts "${text}\n")
endforeach()
string(REPLACE "{{d3}}" "${scripts}" page "${page}")
file(WRITE ${OUT} "namespace skinbench {
extern const char kReportPage[];
const char kReportPage[] = R\"page(${page})page\";
}
")

# Writes HEADER with the commit of SOURCE and whether tracked files differ from it. Without git or a repository of its own (a
# tarball, maybe unpacked inside somebody else's repository) the commit is the one that git wrote into cmake/commit.txt when it
# made the tarball, else "unknown". No lock is taken, so that a build never disturbs a git command running beside it.
set(hash "unknown")
set(dirty "false")
file(STRINGS ${SOURCE}/cmake/commit.txt archived LIMIT_COUNT 1)
if(archived MATCHES "^[0-9a-f]+$")
  set(hash "${archived}")
endif()
find_program(GIT git)
if(GIT AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT} rev-parse HEAD WORKING_DIRECTORY ${SOURCE}
    OUTPUT_VARIABLE answer OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(hash "${answer}")
    execute_process(COMMAND ${GIT} --no-optional-locks status --porcelain --untracked-files=no
      WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE changes ERROR_QUIET)
    if(changes)
      set(dirty "true")
    endif()
  endif()
endif()
# What the sources are, committed or not: the tree of the commit and what differs from it.
set(sources "${hash}")
if(GIT AND EXISTS ${SOURCE}/.git)
  execute_process(COMMAND ${GIT} rev-parse "HEAD^{tree}" WORKING_DIRECTORY ${SOURCE}
    OUTPUT_VARIABLE tree OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET RESULT_VARIABLE failed)
  if(NOT failed)
    set(sources "${tree}")
    if(dirty STREQUAL "true")
      execute_process(COMMAND ${GIT} --no-optional-locks diff HEAD COMMAND ${GIT} hash-object --stdin
        WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE changes OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
      string(SHA1 sources "${tree} ${changes}")
    endif()
  endif()
endif()
set(text "#pragma once\n#define FLOWREST_GIT_HASH \"${hash}\"\n#define FLOWREST_GIT_DIRTY ${dirty}\n#define FLOWREST_SOURCES \"${sources}\"\n")
set(previous "")
if(EXISTS ${HEADER})
  file(READ ${HEADER} previous)
endif()
if(NOT previous STREQUAL text)
  file(WRITE ${HEADER} "${text}")
endif()

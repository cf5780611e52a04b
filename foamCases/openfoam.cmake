# Which OpenFOAM runs are made with and the rheology plug-in is compiled for: Debian's, whatever the shell has sourced, or, with
# -DFLOWREST_OPENFOAM=sourced, the one that the shell had sourced when CMake was first run in a build folder. Sets, for both,
#   openfoam_version         1912
#   openfoam_project         the folder that holds its etc
#   openfoam_programs        the folder of its programs
#   openfoam_mpirun          the mpirun of its Open MPI; empty where there is none
#   openfoam_search          where its programs look for libraries, as in LD_LIBRARY_PATH; empty where they know
#   openfoam_origin          how it came to be the one, for messages
#   openfoam_headers         the folder that holds src/*/lnInclude
#   openfoam_library_folder  the folder of its libraries
#   openfoam_labels          bits of a label
# Debian's is looked for only when a run starts: but for the plug-in, nothing needs it to build.
set(FLOWREST_OPENFOAM debian CACHE STRING "Which OpenFOAM: debian, or sourced for the one that the shell has sourced")
set(FLOWREST_OPENFOAM_HEADERS ${CMAKE_SOURCE_DIR}/build/openfoam-headers
  CACHE PATH "Headers of Debian's OpenFOAM, as scripts/setup unpacks them")

if(FLOWREST_OPENFOAM STREQUAL "debian")
  set(openfoam_version 1912)
  set(openfoam_project /usr/share/openfoam)
  set(openfoam_programs /usr/bin)
  # Debian's mpirun is that of the MPI which an administrator prefers, and its OpenFOAM one of Open MPI's.
  set(openfoam_mpirun /usr/bin/mpirun.openmpi)
  set(openfoam_search "")
  set(openfoam_origin "Debian: apt-get install openfoam")
  set(openfoam_headers "${FLOWREST_OPENFOAM_HEADERS}")
  set(openfoam_library_folder /usr/lib)
  set(openfoam_labels 32)
  return()
elseif(NOT FLOWREST_OPENFOAM STREQUAL "sourced")
  message(FATAL_ERROR "FLOWREST_OPENFOAM is '${FLOWREST_OPENFOAM}'; allowed: debian, sourced")
endif()

set(variables WM_PROJECT_DIR WM_PROJECT_VERSION WM_OPTIONS WM_MPLIB MPI_ARCH_PATH FOAM_APPBIN FOAM_LIBBIN LD_LIBRARY_PATH)
foreach(variable ${variables})
  if(FLOWREST_OPENFOAM_IS_KEPT)
    set(${variable} "${FLOWREST_SOURCED_${variable}}")
  else()
    set(${variable} "$ENV{${variable}}")
  endif()
endforeach()

# Stops where what a sourced shell says is not what is needed.
function(flowrest_needs_in_sourced variable needed)
  if("${${variable}}" STREQUAL "")
    message(FATAL_ERROR "FLOWREST_OPENFOAM is sourced, but ${variable} is not set; source OpenFOAM's etc/bashrc before CMake, or leave "
      "FLOWREST_OPENFOAM at debian")
  elseif(needed AND NOT EXISTS "${${variable}}/${needed}")
    message(FATAL_ERROR "FLOWREST_OPENFOAM is sourced, but ${variable} (${${variable}}) holds no ${needed}")
  endif()
endfunction()

flowrest_needs_in_sourced(WM_PROJECT_VERSION "")
if(NOT WM_PROJECT_VERSION MATCHES "^v([0-9]+)")
  message(FATAL_ERROR "OpenFOAM ${WM_PROJECT_VERSION} is sourced, which is of the OpenFOAM Foundation's line or of none that flowrest "
    "knows; allowed: v1912 or later, from openfoam.com")
endif()
set(openfoam_version ${CMAKE_MATCH_1})
if(openfoam_version LESS 1912)
  message(FATAL_ERROR "OpenFOAM ${WM_PROJECT_VERSION} is sourced; allowed: v1912 or later, from openfoam.com")
endif()
flowrest_needs_in_sourced(WM_OPTIONS "")
if(WM_OPTIONS MATCHES "SPDPInt" OR NOT WM_OPTIONS MATCHES "DPInt(32|64)")
  message(FATAL_ERROR "the OpenFOAM that is sourced is built as ${WM_OPTIONS} (WM_OPTIONS); allowed: double precision, such as "
    "linux64GccDPInt32Opt")
endif()
set(openfoam_labels ${CMAKE_MATCH_1})
flowrest_needs_in_sourced(WM_PROJECT_DIR etc/controlDict)
flowrest_needs_in_sourced(WM_PROJECT_DIR src/finiteVolume/lnInclude/fvMesh.H)
flowrest_needs_in_sourced(FOAM_APPBIN interFoam)
flowrest_needs_in_sourced(FOAM_LIBBIN libfiniteVolume.so)

# A build that configures itself anew in another shell stays what it is.
foreach(variable ${variables})
  set(FLOWREST_SOURCED_${variable} "${${variable}}" CACHE INTERNAL "${variable} when OpenFOAM was chosen")
endforeach()
set(FLOWREST_OPENFOAM_IS_KEPT ON CACHE INTERNAL "A sourced OpenFOAM has been chosen")
if(NOT "$ENV{WM_PROJECT_DIR}" STREQUAL "" AND NOT "$ENV{WM_PROJECT_DIR}" STREQUAL "${WM_PROJECT_DIR}")
  message(WARNING "the OpenFOAM in $ENV{WM_PROJECT_DIR} is sourced now, and this build folder keeps to the one in ${WM_PROJECT_DIR}; "
    "another one wants another build folder")
endif()

set(openfoam_project "${WM_PROJECT_DIR}")
set(openfoam_programs "${FOAM_APPBIN}")
set(openfoam_mpirun "")
if(WM_MPLIB MATCHES "OPENMPI")
  find_program(FLOWREST_SOURCED_MPIRUN NAMES mpirun.openmpi mpirun HINTS "${MPI_ARCH_PATH}/bin")
  mark_as_advanced(FLOWREST_SOURCED_MPIRUN)
  if(FLOWREST_SOURCED_MPIRUN)
    set(openfoam_mpirun "${FLOWREST_SOURCED_MPIRUN}")
  endif()
endif()
set(openfoam_search "${LD_LIBRARY_PATH}")
set(openfoam_origin "v${openfoam_version}, sourced from ${WM_PROJECT_DIR}")
set(openfoam_headers "${WM_PROJECT_DIR}")
set(openfoam_library_folder "${FOAM_LIBBIN}")
message(STATUS "OpenFOAM v${openfoam_version} of ${WM_PROJECT_DIR}, as it was sourced")

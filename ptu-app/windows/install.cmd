@echo off
rem Installs for this user: copies the programs to %LOCALAPPDATA%\ptu, makes them known to the command line, and adds a
rem link to the start menu. Run again, it replaces what it installed. History and settings are elsewhere and stay.
setlocal DisableDelayedExpansion
set "from=%~dp0"
set "target=%LOCALAPPDATA%\ptu"
if not exist "%from%ptu.exe" (
    echo install: ptu.exe is not beside this file; unpack the whole archive first
    exit /b 2
)

if not exist "%target%" mkdir "%target%"
for %%f in (ptu.exe ptu-window.exe ato-under-test.exe) do (
    copy /y "%from%%%f" "%target%\%%f" >nul
    if errorlevel 1 (
        echo install: cannot write %target%\%%f; close the program and run this again
        exit /b 3
    )
)
rem The manuals, as pages for a browser.
if exist "%from%manual" (
    if exist "%target%\manual" rmdir /s /q "%target%\manual"
    xcopy /e /i /q /y "%from%manual" "%target%\manual" >nul
    if errorlevel 1 (
        echo install: cannot write %target%\manual
        exit /b 3
    )
)
rem The scripts are in the program; a folder of an earlier version beside it would be taken in their place.
if exist "%target%\scripts" rmdir /s /q "%target%\scripts"

set "old="
for /f "tokens=1,2,*" %%a in ('reg query HKCU\Environment /v Path 2^>nul') do if /i "%%a"=="Path" set "old=%%c"
set "within=;%old%;"
call set "without=%%within:;%target%;=;%%"
if not "%without%"=="%within%" goto known
set "new=%old%;%target%"
if not defined old set "new=%target%"
reg add HKCU\Environment /v Path /t REG_EXPAND_SZ /d "%new%" /f >nul
if errorlevel 1 (
    echo install: cannot add %target% to the path
    exit /b 3
)
:known

rem The link, and word to the desktop that the path has changed.
where powershell >nul 2>nul
if errorlevel 1 (
    echo install: there is no PowerShell, so no link in the start menu
    goto done
)
powershell -NoProfile -Command ^
    "$l = (New-Object -ComObject WScript.Shell).CreateShortcut([Environment]::GetFolderPath('Programs') + '\ptu.lnk');" ^
    "$l.TargetPath = $env:target + '\ptu-window.exe'; $l.WorkingDirectory = $env:USERPROFILE; $l.Save();" ^
    "[Environment]::SetEnvironmentVariable('PTU_INSTALLED', $null, 'User')"
if errorlevel 1 echo install: no link was made in the start menu
:done
echo ptu is in %target%; open a new command line, or the start menu

/* Runs the program that its arguments name and prints the exit status as Windows has it, in hexadecimal. */
#include <stdio.h>
#include <string.h>
#include <windows.h>

/* The command line behind this program's own name. */
static char *rest(void)
{
    char *line = GetCommandLineA();
    line = *line == '"' ? strchr(line + 1, '"') : strchr(line, ' ');
    return line ? line + 1 + strspn(line + 1, " ") : "";
}

int main(void)
{
    STARTUPINFOA startup = {.cb = sizeof startup};
    PROCESS_INFORMATION process;
    DWORD status;
    if (!CreateProcessA(NULL, rest(), NULL, NULL, FALSE, 0, NULL, NULL, &startup, &process))
        return 1;
    WaitForSingleObject(process.hProcess, INFINITE);
    if (!GetExitCodeProcess(process.hProcess, &status))
        return 1;
    printf("%08lx\n", status);
    return 0;
}

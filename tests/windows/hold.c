/* Keeps the file of its argument open, and others from deleting and renaming it, until its input ends. */
#include <stdio.h>
#include <windows.h>

int main(int count, char **arguments)
{
    HANDLE file = INVALID_HANDLE_VALUE;
    if (count == 2)
        file = CreateFileA(arguments[1], GENERIC_READ, FILE_SHARE_READ, NULL, OPEN_EXISTING, 0, NULL);
    if (file == INVALID_HANDLE_VALUE)
        return 1;
    puts("open");
    fflush(stdout);
    while (getchar() != EOF)
        ;
    return 0;
}

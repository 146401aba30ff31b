"""The linkage, moving: its drawing, the data of the page's cursor, and the script that moves both."""

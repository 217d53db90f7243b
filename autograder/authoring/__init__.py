"""Commands for authors: new exercises, their answers, recordings and messages; and executing all notebooks."""

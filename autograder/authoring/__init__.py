"""What authors use: new exercises, their answers and recordings, the words of the judge, all notebooks executed."""

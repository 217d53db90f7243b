"""Right: send_goal() blocks while another thread spins; prints in German."""
import sys
import threading

import rclpy
from my_robot_interfaces.action import Fibonacci
from rclpy.action import ActionClient
from rclpy.executors import SingleThreadedExecutor

rclpy.init()
node = rclpy.create_node('auftraggeber')
client = ActionClient(node, Fibonacci, '/fibonacci')
executor = SingleThreadedExecutor()
executor.add_node(node)
thread = threading.Thread(target=executor.spin, daemon=True)
thread.start()


def bestelle(ordnung):
    if not client.wait_for_server(timeout_sec=4.0):
        return 'Niemand bietet fibonacci an: not available.'
    handle = client.send_goal_async(
        Fibonacci.Goal(order=ordnung),
        feedback_callback=lambda m: print('bisher:', *m.feedback.partial_sequence),
    )
    fertig = threading.Event()
    handle.add_done_callback(lambda _: fertig.set())
    fertig.wait()
    handle = handle.result()
    if not handle.accepted:
        return 'Der Auftrag wurde abgelehnt (rejected).'
    ende = handle.get_result()
    if ende.status == 4:
        return f'Fertig: {ende.result.sequence.tolist()}'
    return f'Daraus wurde nichts, der Dienst hat aufgegeben (aborted).'


print(bestelle(int(sys.argv[1])))
executor.shutdown()
thread.join()
rclpy.shutdown()
